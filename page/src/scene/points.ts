/** Points on a surface, drawn as discs of a fixed size on the screen. */
import { BufferAttribute, BufferGeometry, Points, ShaderMaterial } from "three";

import { UNCUT } from "./material";

export interface PointsLayer {
  /** (m, 3), mm. */
  readonly positions: Float32Array;
  /** (m, 3), 0 to 255, or one colour for all. */
  readonly colours: Float32Array | readonly [number, number, number];
  /** Diameter, pixels of the page. */
  readonly size: number;
  /** Whether points behind the surface show through, faintly. */
  readonly through?: boolean;
}

const VERTEX = `
attribute vec3 colour;
uniform float size;
uniform float ratio;
uniform float lift;
varying vec3 vColour;
varying vec3 vPlace;
void main() {
  vColour = colour;
  vPlace = (modelMatrix * vec4(position, 1.0)).xyz;
  vec4 placed = modelViewMatrix * vec4(position, 1.0);
  placed.z += lift;
  gl_Position = projectionMatrix * placed;
  gl_PointSize = size * ratio;
}`;

const FRAGMENT = `
uniform vec4 clip;
varying vec3 vColour;
varying vec3 vPlace;
void main() {
  if (dot(vPlace, clip.xyz) > clip.w) discard;
  float r = length(gl_PointCoord - 0.5) * 2.0;
  if (r > 1.0) discard;
  vec3 rim = dot(vColour, vec3(0.299, 0.587, 0.114)) > 0.6 ? vec3(0.08) : vec3(1.0);
  gl_FragColor = vec4(mix(vColour, rim, smoothstep(0.68, 0.78, r)), 1.0);
}`;

/** Whether two layers look the same. */
export function alike(one: PointsLayer, other: PointsLayer): boolean {
  const same = (a: ArrayLike<number>, b: ArrayLike<number>): boolean => {
    if (a === b) return true;
    if (a.length !== b.length) return false;
    for (let i = 0; i < a.length; i += 1) if (a[i] !== b[i]) return false;
    return true;
  };
  return one.size === other.size && one.through === other.through && same(one.colours, other.colours) && same(one.positions, other.positions);
}

/** How far points are lifted towards the viewer, mm, so that the surface does not cut them. */
const LIFT_MM = 1.5;

export function pointsObject(layer: PointsLayer): Points {
  const count = layer.positions.length / 3;
  const colours = new Float32Array(3 * count);
  for (let i = 0; i < colours.length; i += 1)
    colours[i] = (layer.colours.length === 3 && count !== 1 ? layer.colours[i % 3] : layer.colours[i]) / 255;
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(layer.positions, 3));
  geometry.setAttribute("colour", new BufferAttribute(colours, 3));
  const material = new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    depthTest: !layer.through,
    uniforms: {
      size: { value: layer.size },
      ratio: { value: 1 },
      lift: { value: LIFT_MM },
      clip: { value: UNCUT },
    },
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  points.renderOrder = 1;
  return points;
}
