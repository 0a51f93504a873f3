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
uniform float lines;
uniform float phased;
uniform float bare;
uniform vec3 unknown;
uniform vec3 plain;
uniform vec4 clip;
uniform float flatly;
varying vec3 vSeen;
varying vec3 vData;
varying vec3 vNormal;
varying vec3 vPlace;

float placeInScale() {
  if (phased < 0.5) return (vData.x - low) / (high - low);
  return fract(atan(vData.y, vData.x) / 6.283185307179586);
}

vec3 mapped() {
  float t = placeInScale();
  float at = phased < 0.5 ? clamp(t, 0.0, 1.0) : t;
  float count = max(bands, 1.0);
  float shown = bands > 0.5 ? (min(floor(at * count), count - 1.0) + 0.5) / count : at;
  vec3 colour = texture2D(table, vec2((shown * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  if (lines > 0.5) {
    float steps = bands > 0.5 ? count : 10.0;
    float g = t * steps;
    float slope = min(fwidth(g), phased > 0.5 ? fwidth(fract(t + 0.5) * steps) : 1e9);
    float near = abs(fract(g - 0.5) - 0.5) / max(slope, 1e-6);
    float within = phased > 0.5 ? 1.0 : step(-0.001, t) * step(t, 1.001);
    colour = mix(colour, vec3(0.07), within * (1.0 - smoothstep(0.5, 1.3, near)) * 0.85);
  }
  return colour;
}

void main() {
  if (dot(vPlace, clip.xyz) > clip.w) discard;
  vec3 n = flatly > 0.5 ? normalize(cross(dFdx(vSeen), dFdy(vSeen))) : normalize(vNormal);
  vec3 base = bare > 0.5 ? plain : (vData.z > 0.999 ? mapped() : unknown);
  if (!gl_FrontFacing) {
    if (flatly < 0.5) n = -n;
    base = mix(base, vec3(0.35), 0.55) * 0.62;
  }
  float light = 0.60 + 0.40 * max(dot(n, normalize(vec3(0.25, 0.45, 1.0))), 0.0);
  gl_FragColor = vec4(base * light, 1.0);
}`;

/** Beyond all surfaces: nothing is cut away. */
export const UNCUT = new Vector4(0, 0, 0, 1);

export function surfaceMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side: DoubleSide,
    uniforms: {
      table: { value: null },
      low: { value: 0 },
      high: { value: 1 },
      bands: { value: 10 },
      lines: { value: 0 },
      phased: { value: 0 },
      bare: { value: 1 },
      unknown: { value: new Vector3(...UNKNOWN).divideScalar(255) },
      plain: { value: new Vector3(0.80, 0.76, 0.71) },
      clip: { value: UNCUT },
      flatly: { value: 0 },
    },
  });
}

/** Sets the colours of a surface; without a scale it is bare. */
export function colourBy(material: ShaderMaterial, scale: ColourScale | null): void {
  const { uniforms } = material;
  uniforms["bare"].value = scale ? 0 : 1;
  if (!scale) return;
  uniforms["low"].value = scale.low;
  uniforms["high"].value = scale.high;
  uniforms["bands"].value = scale.bands;
  uniforms["lines"].value = scale.lines ? 1 : 0;
  uniforms["phased"].value = scale.palette === "cyclic" ? 1 : 0;
  (uniforms["table"].value as DataTexture | null)?.dispose();
  const table = new DataTexture(colourTable(scale.palette, 0), 256, 1, RGBAFormat);
  table.minFilter = table.magFilter = LinearFilter;
  table.wrapS = table.wrapT = ClampToEdgeWrapping;
  table.needsUpdate = true;
  uniforms["table"].value = table;
}
