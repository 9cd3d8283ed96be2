// Points from the records' own bits: two uvec4 attributes of one interleaved buffer.
import * as THREE from "three";
import { kColours, table, type Colour } from "./color_maps";
import { kWords } from "./points";

const kVertex = `
precision highp float;
precision highp int;
in uvec4 head; // x y z, colours and intensity
in uvec4 tail; // temperature, counts, sigma and valid, time
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform sampler2D ramp;
uniform int mode; // as kColours
uniform vec2 range; // the legend's ends: K, m, intensity
uniform vec3 origin; // the LIDAR [m]
uniform vec3 unknown;
uniform float size; // [px], 5 m away
out vec3 shade;

bool isNan(uint bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }

vec3 ramped(float value) {
  float t = clamp((value - range.x) / max(range.y - range.x, 1e-6), 0.0, 1.0);
  return texelFetch(ramp, ivec2(int(t * 255.0 + 0.5), 0), 0).rgb;
}

vec3 color(vec3 point) {
  uint colors = head.w;
  uint intensity = colors >> 24;
  uint valid = tail.z >> 16;
  if (mode == 0 && (colors & 0xffffffu) != 0u)
    return vec3(colors & 255u, (colors >> 8) & 255u, (colors >> 16) & 255u) / 255.0;
  if (mode == 1 && !isNan(tail.x)) return ramped(uintBitsToFloat(tail.x));
  if (mode == 2) return ramped(distance(point, origin));
  if (mode == 3 && intensity != 255u) return ramped(float(intensity));
  if (mode == 4 && valid != 0u) return texelFetch(ramp, ivec2(min(int(valid), 255), 0), 0).rgb;
  return unknown;
}

void main() {
  vec3 point = uintBitsToFloat(head.xyz);
  vec4 seen = modelViewMatrix * vec4(point, 1.0);
  bool missing = isNan(head.x) || isNan(head.y) || isNan(head.z);
  gl_Position = missing ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * seen;
  gl_PointSize = clamp(size * 5.0 / max(-seen.z, 0.1), max(1.0, 0.6 * size), 3.0 * size);
  shade = color(point);
}`;

const kFragment = `
precision mediump float;
in vec3 shade;
out vec4 pixel;
void main() { pixel = vec4(shade, 1.0); }`;

const textures = new Map<Colour, THREE.DataTexture>();
function textureOf(colour: Colour): THREE.DataTexture {
  const made = textures.get(colour);
  if (made) return made;
  const texture = new THREE.DataTexture(table(colour), 256, 1);
  texture.needsUpdate = true;
  textures.set(colour, texture);
  return texture;
}

export function makeMaterial(): THREE.RawShaderMaterial {
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader: kVertex, fragmentShader: kFragment,
    uniforms: {
      ramp: { value: textureOf("temperature") }, mode: { value: 0 }, range: { value: new THREE.Vector2(0, 1) },
      origin: { value: new THREE.Vector3() }, unknown: { value: new THREE.Vector3(0.3, 0.33, 0.37) }, size: { value: 2 },
    },
  });
}

/// `range` in the values' own units (K, m, intensity).
export function setColour(material: THREE.RawShaderMaterial, colour: Colour, range: [number, number]): void {
  material.uniforms.mode.value = kColours.findIndex(({ id }) => id === colour);
  material.uniforms.ramp.value = textureOf(colour);
  (material.uniforms.range.value as THREE.Vector2).set(...range);
}

/// A geometry over records where they lie.
export function makeGeometry(words: Uint32Array): THREE.BufferGeometry {
  const records = new THREE.InterleavedBuffer(words, kWords);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("head", new THREE.InterleavedBufferAttribute(records, 4, 0));
  geometry.setAttribute("tail", new THREE.InterleavedBufferAttribute(records, 4, 4));
  return geometry;
}
