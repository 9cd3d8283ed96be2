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
uniform int mode; // as kColours
uniform vec2 range; // the legend's ends: K, m, intensity
uniform vec3 origin; // the LIDAR [m]
uniform vec3 unknown;
uniform float blend; // of the temperature, the rest of the colour
uniform vec3 low; // what is shown
uniform vec3 high;
uniform float voxel; // radius of what is in a voxel [m]
uniform float grow; // times the radius
uniform float focal; // pixels that 1 m is long, 1 m away
uniform vec2 sizes; // least and most diameter [px]
out vec3 shade;
flat out vec3 disc; // how deep it is, its radius [m], its diameter [px]

bool isNan(uint bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }

vec3 ramped(float value) {
  float t = clamp((value - range.x) / max(range.y - range.x, 1e-6), 0.0, 1.0);
  return texelFetch(ramp, ivec2(int(t * 255.0 + 0.5), 0), 0).rgb;
}

vec3 color(vec3 point) {
  uint colors = head.w;
  uint intensity = colors >> 24;
  uint valid = tail.z >> 16;
  bool coloured = (mode == 0 || mode == 5) && (colors & 0xffffffu) != 0u;
  bool warm = (mode == 1 || mode == 5) && !isNan(tail.x);
  vec3 rgb = vec3(colors & 255u, (colors >> 8) & 255u, (colors >> 16) & 255u) / 255.0;
  if (coloured && warm) return mix(rgb, ramped(uintBitsToFloat(tail.x)), blend);
  if (coloured) return rgb;
  if (warm) return ramped(uintBitsToFloat(tail.x));
  if (mode == 2) return ramped(distance(point, origin));
  if (mode == 3 && intensity != 255u) return ramped(float(intensity));
  if (mode == 4 && valid != 0u) return texelFetch(ramp, ivec2(min(int(valid), 255), 0), 0).rgb;
  return unknown;
}

void main() {
  vec3 point = uintBitsToFloat(head.xyz);
  vec4 seen = modelViewMatrix * vec4(point, 1.0);
  bool missing = isNan(head.x) || isNan(head.y) || isNan(head.z)
    || any(lessThan(point, low)) || any(greaterThan(point, high));
  gl_Position = missing ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * seen;
  float radius = grow * (angle > 0.0 ? angle * ANGLE_UNIT * distance(point, origin) : voxel);
  gl_PointSize = clamp(2.0 * radius * focal / max(-seen.z, 0.01), sizes.x, sizes.y);
  disc = vec3(-seen.z, radius, gl_PointSize);
  shade = color(point);
}`;

// A disc's rim lies deeper than its middle: where discs overlap each shows what is nearest to its own
// point, and noise in range does not show as specks.
const kFragment = `
precision highp float;
in vec3 shade;
flat in vec3 disc;
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

export interface Materials {
  fine: THREE.RawShaderMaterial; // round
  quick: THREE.RawShaderMaterial; // square, for who draws slowly, while the view moves
  uniforms: Record<string, THREE.IUniform>; // of both
}

export function makeMaterials(): Materials {
  const uniforms = {
    ramp: { value: textureOf("temperature") }, mode: { value: 0 }, range: { value: new THREE.Vector2(0, 1) },
    origin: { value: new THREE.Vector3() }, unknown: { value: new THREE.Vector3() },
    blend: { value: 0.5 }, low: { value: new THREE.Vector3() }, high: { value: new THREE.Vector3() },
    voxel: { value: 0 }, grow: { value: 1 }, focal: { value: 1 }, sizes: { value: new THREE.Vector2(1, 1) },
    projection: { value: new THREE.Vector2() },
  };
  const make = (defines: Record<string, string>) => {
    const material = new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3, vertexShader: kVertex, fragmentShader: kFragment,
      defines: { ANGLE_UNIT: kAngleUnit.toExponential(), ...defines },
    });
    material.uniforms = uniforms;
    return material;
  };
  return { fine: make({ ROUND: "1" }), quick: make({}), uniforms };
}

/// `range` in the values' own units (K, m, intensity).
export function setColour({ uniforms }: Materials, colour: Colour, range: [number, number]): void {
  uniforms.mode.value = kColours.findIndex(({ id }) => id === colour);
  uniforms.ramp.value = textureOf(colour);
  (uniforms.range.value as THREE.Vector2).set(...range);
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
