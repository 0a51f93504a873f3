/** The look of a surface: bands of colour decided for each pixel, so their borders are sharp. */
import { ClampToEdgeWrapping, DataTexture, DoubleSide, LinearFilter, RGBAFormat, ShaderMaterial, Vector3, Vector4 } from "three";

import { colourTable } from "../colour/palettes";
import { UNKNOWN, type ColourScale } from "../colour/scale";

const VERTEX = `
attribute vec3 data;
varying vec3 vData;
varying vec3 vNormal;
varying vec3 vPlace;
varying vec3 vSeen;
void main() {
  vSeen = (modelViewMatrix * vec4(position, 1.0)).xyz;
  vData = data;
  vNormal = normalMatrix * normal;
  vPlace = (modelMatrix * vec4(position, 1.0)).xyz;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// data: value, 0, known — or, cyclic, cosine and sine of the phase, known.
const FRAGMENT = `
uniform sampler2D table;
uniform float low;
uniform float high;
uniform float bands;
uniform vec3 unknown;
uniform vec3 plain;
uniform vec4 clip;
varying vec3 vSeen;
varying vec3 vData;
varying vec3 vNormal;
varying vec3 vPlace;

float placeInScale() {
#ifdef CYCLIC
  return fract(atan(vData.y, vData.x) / 6.283185307179586);
#else
  return (vData.x - low) / (high - low);
#endif
}

vec3 mapped() {
  float t = placeInScale();
#ifdef CYCLIC
  float at = t;
#else
  float at = clamp(t, 0.0, 1.0);
#endif
  float count = max(bands, 1.0);
  float shown = bands > 0.5 ? (min(floor(at * count), count - 1.0) + 0.5) / count : at;
  vec3 colour = texture2D(table, vec2((shown * 255.0 + 0.5) / 256.0, 0.5)).rgb;
#ifdef LINES
  float steps = bands > 0.5 ? count : 10.0;
  float g = t * steps;
#ifdef CYCLIC
  float slope = min(fwidth(g), fwidth(fract(t + 0.5) * steps));
  float within = 1.0;
#else
  float slope = fwidth(g);
  float within = step(-0.001, t) * step(t, 1.001);
#endif
  float near = abs(fract(g - 0.5) - 0.5) / max(slope, 1e-6);
  colour = mix(colour, vec3(0.07), within * (1.0 - smoothstep(0.5, 1.3, near)) * 0.85);
#endif
  return colour;
}

void main() {
#ifdef CUT
  if (dot(vPlace, clip.xyz) > clip.w) discard;
#endif
#ifdef FLAT
  vec3 n = normalize(cross(dFdx(vSeen), dFdy(vSeen)));
#else
  vec3 n = normalize(vNormal);
#endif
#ifdef BARE
  vec3 base = plain;
#else
  vec3 base = vData.z > 0.999 ? mapped() : unknown;
#endif
  if (!gl_FrontFacing) {
#ifndef FLAT
    n = -n;
#endif
    base = mix(base, vec3(0.35), 0.55) * 0.62;
  }
  float light = 0.60 + 0.40 * max(dot(n, normalize(vec3(0.25, 0.45, 1.0))), 0.0);
  gl_FragColor = vec4(base * light, 1.0);
}`;

/** What a surface's shader may leave out: drawing in software, each instruction of a pixel counts. */
export type Feature = "BARE" | "CYCLIC" | "LINES" | "FLAT" | "CUT";

/** Switches features of a surface's shader. */
export function feature(material: ShaderMaterial, wanted: Partial<Record<Feature, boolean>>): void {
  for (const [name, on] of Object.entries(wanted)) {
    if (on === name in material.defines) continue;
    if (on) material.defines[name] = "";
    else delete material.defines[name];
    material.needsUpdate = true;
  }
}

/** Beyond all surfaces: nothing is cut away. */
export const UNCUT = new Vector4(0, 0, 0, 1);

export function surfaceMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side: DoubleSide,
    defines: { BARE: "" },
    uniforms: {
      table: { value: null },
      low: { value: 0 },
      high: { value: 1 },
      bands: { value: 10 },
      unknown: { value: new Vector3(...UNKNOWN).divideScalar(255) },
      plain: { value: new Vector3(0.80, 0.76, 0.71) },
      clip: { value: UNCUT },
    },
  });
}

/** Sets the colours of a surface; without a scale it is bare. */
export function colourBy(material: ShaderMaterial, scale: ColourScale | null): void {
  const { uniforms } = material;
  feature(material, { BARE: !scale, LINES: scale?.lines ?? false, CYCLIC: scale?.palette === "cyclic" });
  if (!scale) return;
  uniforms["low"].value = scale.low;
  uniforms["high"].value = scale.high;
  uniforms["bands"].value = scale.bands;
  (uniforms["table"].value as DataTexture | null)?.dispose();
  const table = new DataTexture(colourTable(scale.palette, 0), 256, 1, RGBAFormat);
  table.minFilter = table.magFilter = LinearFilter;
  table.wrapS = table.wrapT = ClampToEdgeWrapping;
  table.needsUpdate = true;
  uniforms["table"].value = table;
}
