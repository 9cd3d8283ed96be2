// Eye-dome lighting (Boucheny 2009): a pixel is the darker the further its surroundings stand in front
// of it, so that depth shows without normals. The cloud is drawn into a texture with its depth; then
// all of it onto the canvas, with the depth, so that lines can be drawn among the points. Small holes
// of a surface are closed.
import * as THREE from "three";

const kVertex = `
precision highp float;
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }`;

// As calib/present/pictures/internal/splats.cc shades pictures, with half of its samples.
const kFragment = `
precision highp float;
precision highp sampler2D;
uniform sampler2D colors;
uniform sampler2D depths;
uniform vec2 projection; // as projectionOf
uniform float strength; // 0: no lighting
uniform int reach; // [px]
uniform vec3 above; // the background's ends
uniform vec3 below;
out vec4 pixel;

const float kBelongs = 0.015; // of the logarithm: what is nearer by less is the same surface
const float kBound = 0.06; // one large step is to draw a line, not to blacken a surface

float depthAt(ivec2 at) { return texelFetch(depths, clamp(at, ivec2(0), textureSize(depths, 0) - 1), 0).r; }
float logOf(float depth) { return log2(projection.y / (projection.x - (2.0 * depth - 1.0))); }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float depth = depthAt(at);
  float here = logOf(depth);
  vec4 near, far; // right, left, above, below
  ivec2 steps[4] = ivec2[4](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
  for (int i = 0; i < 4; ++i) {
    near[i] = logOf(depthAt(at + reach * steps[i]));
    far[i] = logOf(depthAt(at + 3 * reach * steps[i]));
  }
  vec3 color = texelFetch(colors, at, 0).rgb;
  float light = 1.0;
  // A hole in a surface has nearer ones on at least three sides, and takes their mean.
  vec3 around = vec3(0.0);
  float sides = 0.0, nearest = 1.0;
  for (int i = 0; i < 4; ++i) {
    float limit = here - kBelongs;
    if (min(near[i], far[i]) >= limit) continue;
    ivec2 found = at + (near[i] < limit ? 1 : 3) * reach * steps[i];
    around += texelFetch(colors, found, 0).rgb;
    nearest = min(nearest, depthAt(found));
    sides += 1.0;
  }
  if (sides > 2.5) {
    color = around / sides;
    depth = nearest;
  } else if (depth == 1.0) {
    color = mix(below, above, gl_FragCoord.y / float(textureSize(depths, 0).y));
  } else if (strength > 0.0) {
    vec4 sum = clamp(here - near, 0.0, kBound) + clamp(here - far, 0.0, kBound);
    light = exp(-strength * (sum.x + sum.y + sum.z + sum.w));
  }
  gl_FragDepth = depth;
  pixel = vec4(light * color, 1.0);
}`;

const kStrength = 4;

export class Lighting {
  on = true;
  private readonly target = new THREE.WebGLRenderTarget(1, 1, {
    minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthTexture: new THREE.DepthTexture(1, 1, THREE.UnsignedIntType),
  });
  private readonly material = new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader: kVertex, fragmentShader: kFragment, depthFunc: THREE.AlwaysDepth,
    uniforms: {
      colors: { value: this.target.texture }, depths: { value: this.target.depthTexture }, projection: { value: new THREE.Vector2() },
      strength: { value: kStrength }, reach: { value: 1 }, above: { value: new THREE.Vector3() }, below: { value: new THREE.Vector3() },
    },
  });
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.Camera();

  constructor() {
    const triangle = new THREE.BufferGeometry();
    triangle.setAttribute("position", new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    const screen = new THREE.Mesh(triangle, this.material);
    screen.frustumCulled = false;
    this.scene.add(screen);
  }

  /// [px of the screen]; `ratio`: of those to CSS px.
  resize(width: number, height: number, ratio: number): void {
    this.target.setSize(width, height);
    this.material.uniforms.reach.value = Math.max(1, Math.round(ratio));
  }

  setBackground(above: number, below: number): void {
    const { uniforms } = this.material;
    (uniforms.above.value as THREE.Vector3).setScalar(above);
    (uniforms.below.value as THREE.Vector3).setScalar(below);
  }

  /// `points` as seen by `camera`, onto the canvas.
  draw(gl: THREE.WebGLRenderer, points: THREE.Scene, camera: THREE.PerspectiveCamera): void {
    const { uniforms } = this.material;
    (uniforms.projection.value as THREE.Vector2).copy(projectionOf(camera));
    uniforms.strength.value = this.on ? kStrength : 0;
    gl.setRenderTarget(this.target);
    gl.clear();
    gl.render(points, camera);
    gl.setRenderTarget(null);
    gl.render(this.scene, this.camera);
  }
}

/// x and y of: z / w = x - y / depth.
export function projectionOf({ near, far }: THREE.PerspectiveCamera): THREE.Vector2 {
  return new THREE.Vector2((far + near) / (far - near), (2 * far * near) / (far - near));
}
