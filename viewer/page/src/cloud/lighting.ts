// Eye-dome lighting (Boucheny 2009): a pixel is the darker the further its surroundings stand in front
// of it, so that depth shows without normals. The cloud is drawn into a texture with its depth; then
// all of it onto the canvas, with the depth, so that lines can be drawn among the points. Small holes
// of a surface are closed.
import * as THREE from "three";

const kVertex = `
precision highp float;
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }`;

// As calib/present/pictures/internal/splats.cc shades pictures and closes their holes, with half of its
// samples. 1 / depth is linear in what the texture holds; its ratios stand for differences of logarithms.
const kFragment = `
precision highp float;
precision highp sampler2D;
uniform sampler2D colors;
uniform sampler2D depths;
uniform float infinite; // what the texture would hold at infinity
uniform float strength; // 0: no lighting
uniform float reach; // [px]
uniform vec3 above; // the background's ends
uniform vec3 below;
out vec4 pixel;

const float kBelongs = 0.01; // nearer by less, as a share: the same surface
const float kBound = 0.04; // one large step is to draw a line, not to blacken a surface

void main() {
  vec2 texel = 1.0 / vec2(textureSize(depths, 0));
  vec2 at = gl_FragCoord.xy * texel;
  float depth = texture(depths, at).r;
  vec2 right = vec2(reach * texel.x, 0.0), up = vec2(0.0, reach * texel.y);
  vec4 near = vec4(texture(depths, at + right).r, texture(depths, at - right).r,
                   texture(depths, at + up).r, texture(depths, at - up).r);
  vec4 far = vec4(texture(depths, at + 3.0 * right).r, texture(depths, at - 3.0 * right).r,
                  texture(depths, at + 3.0 * up).r, texture(depths, at - 3.0 * up).r);
  // How much nearer the surroundings are, as a share.
  float here = 1.0 / (infinite - depth);
  vec4 nearer = (infinite - near) * here - 1.0;
  vec4 farther = (infinite - far) * here - 1.0;
  gl_FragDepth = depth;
  // A hole in a surface has nearer ones on at least three sides.
  vec4 sides = step(kBelongs, max(nearer, farther));
  float count = dot(sides, vec4(1.0));
  if (count > 2.5) {
    vec4 reached = 3.0 - 2.0 * step(kBelongs, nearer);
    vec3 sum = sides.x * texture(colors, at + reached.x * right).rgb + sides.y * texture(colors, at - reached.y * right).rgb
      + sides.z * texture(colors, at + reached.z * up).rgb + sides.w * texture(colors, at - reached.w * up).rgb;
    vec4 around = min(near, far);
    gl_FragDepth = min(min(around.x, around.y), min(around.z, around.w));
    pixel = vec4(sum / count, 1.0);
  } else if (depth == 1.0) {
    pixel = vec4(mix(below, above, at.y), 1.0);
  } else {
    vec4 sum = clamp(nearer, 0.0, kBound) + clamp(farther, 0.0, kBound);
    pixel = vec4(exp(-strength * dot(sum, vec4(1.0))) * texture(colors, at).rgb, 1.0);
  }
}`;

const kStrength = 6;

export class Lighting {
  on = true;
  private readonly target = new THREE.WebGLRenderTarget(1, 1, {
    minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthTexture: new THREE.DepthTexture(1, 1, THREE.UnsignedIntType),
  });
  private readonly material = new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader: kVertex, fragmentShader: kFragment, depthFunc: THREE.AlwaysDepth,
    uniforms: {
      colors: { value: this.target.texture }, depths: { value: this.target.depthTexture }, infinite: { value: 1 },
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
    uniforms.infinite.value = 0.5 + 0.5 * projectionOf(camera).x;
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
