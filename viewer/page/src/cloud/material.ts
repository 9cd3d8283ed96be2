// Points from the records' own bits: two uvec4 attributes of one interleaved buffer, and how large
// each is to be. A point is a disc that closes the gap to its neighbours.
import * as THREE from "three";
import { kColours, table, type Colour } from "./color_maps";
import { kWords, type Points } from "./points";
import { angularRadii, kAngleUnit } from "./spacing";

const kVertex = `
precision highp float;
precision highp int;
in uvec4 head; // x y z, colours and intensity
in uvec4 tail; // temperature, counts, sigma and valid, time
in float angle; // the disc's radius as the LIDAR sees it, see angularRadii; 0: as large as a voxel
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform sampler2D ramp;
uniform vec2 range; // the legend's ends: K, m, intensity
uniform vec3 origin; // the LIDAR [m]
uniform vec3 unknown;
uniform float blend; // of the temperature, the rest of the colour
uniform float before; // what no camera saw is not shown nearer to the eye [m]
uniform vec3 low; // what is shown
uniform vec3 high;
uniform float voxel; // radius of what is in a voxel [m]
uniform float grow; // times the radius
uniform float focal; // pixels that 1 m is long, 1 m away
uniform vec2 sizes; // least and most diameter [px]
out vec3 shade;
#ifdef ROUND
flat out vec3 disc; // how deep it is, its radius [m], its diameter [px]
#endif

bool isNan(uint bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }

vec3 ramped(float value) {
  float t = clamp((value - range.x) / max(range.y - range.x, 1e-6), 0.0, 1.0);
  return texelFetch(ramp, ivec2(int(t * 255.0 + 0.5), 0), 0).rgb;
}

// MODE: as kColours. Known to the compiler, as software rendering would reckon all of them.
vec3 color(vec3 point) {
#if MODE == 0 || MODE == 5
  bool coloured = (head.w & 0xffffffu) != 0u;
  vec3 rgb = vec3(head.w & 255u, (head.w >> 8) & 255u, (head.w >> 16) & 255u) / 255.0;
#endif
#if MODE == 0
  return coloured ? rgb : unknown;
#elif MODE == 1
  return isNan(tail.x) ? unknown : ramped(uintBitsToFloat(tail.x));
#elif MODE == 2
  return ramped(distance(point, origin));
#elif MODE == 3
  return head.w >> 24 == 255u ? unknown : ramped(float(head.w >> 24));
#elif MODE == 4
  uint valid = tail.z >> 16;
  return valid == 0u ? unknown : texelFetch(ramp, ivec2(min(int(valid), 255), 0), 0).rgb;
#else
  if (isNan(tail.x)) return coloured ? rgb : unknown;
  vec3 warm = ramped(uintBitsToFloat(tail.x));
  return coloured ? mix(rgb, warm, blend) : warm;
#endif
}

void main() {
  vec3 point = uintBitsToFloat(head.xyz);
  vec4 seen = modelViewMatrix * vec4(point, 1.0);
  bool missing = isNan(head.x) || isNan(head.y) || isNan(head.z) || any(lessThan(point, low)) || any(greaterThan(point, high))
    || (-seen.z < before && tail.z >> 16 == 0u);
  gl_Position = missing ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * seen;
  float radius = grow * (angle > 0.0 ? angle * ANGLE_UNIT * distance(point, origin) : voxel);
  gl_PointSize = clamp(2.0 * radius * focal / max(-seen.z, 0.01), sizes.x, sizes.y);
#ifdef ROUND
  disc = vec3(-seen.z, radius, gl_PointSize);
#endif
  shade = color(point);
}`;

// A disc's rim lies deeper than its middle: where discs overlap each shows what is nearest to its own
// point, and noise in range does not show as specks.
const kFragment = `
precision highp float;
in vec3 shade;
#ifdef ROUND
flat in vec3 disc;
#endif
uniform vec2 projection; // as projectionOf
out vec4 pixel;
void main() {
#ifdef ROUND
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  float away = dot(at, at);
  if (away > 1.0 && disc.z > 2.5) discard;
  float depth = disc.x + disc.y * away;
  gl_FragDepth = 0.5 + 0.5 * (projection.x - projection.y / depth);
#endif
  pixel = vec4(shade, 1.0);
}`;

const textures = new Map<Colour, THREE.DataTexture>();
function textureOf(colour: Colour): THREE.DataTexture {
  const made = textures.get(colour);
  if (made) return made;
  const texture = new THREE.DataTexture(table(colour), 256, 1);
  texture.needsUpdate = true;
  textures.set(colour, texture);
  return texture;
}

/// Materials for each colour, round discs and, for who draws slowly, squares.
export class Materials {
  readonly uniforms = {
    ramp: { value: textureOf("temperature") }, range: { value: new THREE.Vector2(0, 1) },
    origin: { value: new THREE.Vector3() }, unknown: { value: new THREE.Vector3() }, blend: { value: 0.5 }, before: { value: 0 },
    low: { value: new THREE.Vector3() }, high: { value: new THREE.Vector3() }, // what is shown
    voxel: { value: 0 }, grow: { value: 1 }, focal: { value: 1 }, sizes: { value: new THREE.Vector2(1, 1) },
    projection: { value: new THREE.Vector2() },
  };
  private colour: Colour = "rgb";
  private readonly made = new Map<string, THREE.RawShaderMaterial>();

  /// `range` in the values' own units (K, m, intensity).
  setColour(colour: Colour, range: [number, number]): void {
    this.colour = colour;
    this.uniforms.ramp.value = textureOf(colour);
    this.uniforms.range.value.set(...range);
  }

  now(round: boolean): THREE.RawShaderMaterial {
    const key = `${this.colour} ${round}`;
    const known = this.made.get(key);
    if (known) return known;
    const mode = kColours.findIndex(({ id }) => id === this.colour);
    const made = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3, vertexShader: kVertex, fragmentShader: kFragment,
      defines: { ANGLE_UNIT: kAngleUnit.toExponential(), MODE: mode, ...(round ? { ROUND: 1 } : {}) },
    });
    made.uniforms = this.uniforms;
    this.made.set(key, made);
    return made;
  }
}

/// A geometry over records where they lie, and the points' radii.
function geometryOf(words: Uint32Array, radii: Uint16Array): THREE.BufferGeometry {
  const records = new THREE.InterleavedBuffer(words, kWords);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("head", new THREE.InterleavedBufferAttribute(records, 4, 0));
  geometry.setAttribute("tail", new THREE.InterleavedBufferAttribute(records, 4, 4));
  geometry.setAttribute("angle", new THREE.BufferAttribute(radii, 1));
  return geometry;
}

export const sweepGeometry = (points: Points): THREE.BufferGeometry => geometryOf(points.words, angularRadii(points));
export const voxelGeometry = (words: Uint32Array): THREE.BufferGeometry => geometryOf(words, new Uint16Array(words.length / kWords));
