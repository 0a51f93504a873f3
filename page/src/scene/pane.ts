/** One picture of a stage: a surface with colours, points on it, a caption. */
import {
  BufferAttribute,
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  Plane,
  Points,
  Scene,
  type ShaderMaterial,
  Vector3,
  type Vector4,
} from "three";

import type { ColourScale } from "../colour/scale";
import { h } from "../dom";
import { colourBy, feature, surfaceMaterial } from "./material";
import { vertexNormals } from "./normals";
import { alike, pointsObject, type PointsLayer } from "./points";

export class Pane {
  readonly scene = new Scene();
  readonly caption = h("figcaption", { class: "pane-caption" });
  positions = new Float32Array(0);
  faces: Uint32Array = new Uint32Array(0);
  readonly material: ShaderMaterial = surfaceMaterial();
  /** Whether it looks otherwise than when it was last drawn. */
  stale = true;
  private readonly geometry = new BufferGeometry();
  private readonly mesh = new Mesh(this.geometry, this.material);
  private readonly layers = new Map<string, { layer: PointsLayer; object: Points }>();
  private readonly marks = new Group();
  private edges: LineSegments | null = null;
  private scale: ColourScale | null = null;
  private values: Float32Array | null = null;
  private readonly changed: () => void;

  /** `changed` is called whenever it has become stale. */
  constructor(changed: () => void) {
    this.changed = () => {
      this.stale = true;
      changed();
    };
    this.mesh.frustumCulled = false;
    this.scene.add(this.mesh, this.marks);
  }

  /** Words under the picture. */
  setCaption(words: string): void {
    this.caption.textContent = words;
  }

  /** Shows another surface: positions (n, 3) in mm and faces (f, 3). It starts without colours. */
  setSurface(positions: Float32Array, faces: Uint32Array): void {
    const n = positions.length / 3;
    this.geometry.dispose();
    this.positions = positions.slice();
    this.faces = faces;
    this.geometry.setAttribute("position", new BufferAttribute(this.positions, 3));
    this.geometry.setAttribute("normal", new BufferAttribute(new Float32Array(3 * n), 3));
    this.geometry.setAttribute("data", new BufferAttribute(new Float32Array(3 * n), 3));
    this.geometry.setIndex(new BufferAttribute(faces, 1));
    this.values = null;
    this.scale = null;
    colourBy(this.material, null);
    if (this.edges) this.setEdges(true);
    this.movePositions(positions);
  }

  /** Moves the vertices; the faces stay. */
  movePositions(positions: ArrayLike<number>): void {
    this.positions.set(positions);
    const normal = this.geometry.getAttribute("normal") as BufferAttribute;
    vertexNormals(this.positions, this.faces, normal.array as Float32Array);
    normal.needsUpdate = true;
    (this.geometry.getAttribute("position") as BufferAttribute).needsUpdate = true;
    this.changed();
  }

  /** Colours the surface by one value a vertex; NaN is grey, null leaves it bare. */
  setValues(values: Float32Array | null, scale: ColourScale | null): void {
    if (values === this.values && scale === this.scale) return;
    this.values = values;
    this.setScale(scale);
  }

  /** Changes the colours and leaves the values. */
  setScale(scale: ColourScale | null): void {
    const shown = this.values ? scale : null;
    if (shown !== this.scale || !shown) colourBy(this.material, shown);
    this.scale = shown;
    if (this.values && shown) this.fillData(this.values, shown);
    this.changed();
  }

  /** Points drawn as discs, by the layer's name; null takes the layer away. */
  setPoints(name: string, layer: PointsLayer | null): void {
    const before = this.layers.get(name);
    const wanted = layer?.positions.length ? layer : null;
    if (!before && !wanted) return;
    if (before && wanted && alike(before.layer, wanted)) return;
    if (before) {
      this.marks.remove(before.object);
      before.object.geometry.dispose();
      (before.object.material as ShaderMaterial).dispose();
      this.layers.delete(name);
    }
    if (wanted) {
      const object = pointsObject(wanted);
      this.layers.set(name, { layer: wanted, object });
      this.marks.add(object);
    }
    this.changed();
  }

  /** Shades each face by itself, so that one sees the faces there are. */
  setFlat(on: boolean): void {
    feature(this.material, { FLAT: on });
    this.changed();
  }

  /** Draws the edges of the faces. */
  setEdges(on: boolean): void {
    if (on && this.edges?.geometry.getAttribute("position") === this.geometry.getAttribute("position")) return;
    if (!on && !this.edges) return;
    if (this.edges) {
      this.scene.remove(this.edges);
      this.edges.geometry.dispose();
      this.edges = null;
    }
    if (on) {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", this.geometry.getAttribute("position"));
      geometry.setIndex(new BufferAttribute(edgesOf(this.faces), 1));
      const material = new LineBasicMaterial({ color: 0x202830, transparent: true, opacity: 0.45 });
      this.edges = new LineSegments(geometry, material);
      this.edges.frustumCulled = false;
      this.scene.add(this.edges);
    }
    this.changed();
  }

  cutBy(plane: Vector4, pixelRatio: number): void {
    this.material.uniforms["clip"].value = plane;
    feature(this.material, { CUT: plane.x !== 0 || plane.y !== 0 || plane.z !== 0 });
    if (this.edges) {
      const normal = new Vector3(-plane.x, -plane.y, -plane.z);
      const cuts = normal.length() > 0;
      (this.edges.material as LineBasicMaterial).clippingPlanes = cuts ? [new Plane(normal, plane.w)] : null;
    }
    for (const { object } of this.layers.values()) {
      const { uniforms } = object.material as ShaderMaterial;
      uniforms["clip"].value = plane;
      uniforms["ratio"].value = pixelRatio;
    }
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
    for (const name of [...this.layers.keys()]) this.setPoints(name, null);
    this.caption.remove();
  }

  private fillData(values: Float32Array, scale: ColourScale): void {
    const data = this.geometry.getAttribute("data") as BufferAttribute;
    const array = data.array as Float32Array;
    const turn = (2 * Math.PI) / (scale.high - scale.low);
    const cyclic = scale.palette === "cyclic";
    for (let i = 0; i < values.length; i += 1) {
      const known = Number.isFinite(values[i]);
      const value = known ? values[i] : 0;
      const phase = (value - scale.low) * turn;
      array[3 * i] = cyclic ? Math.cos(phase) : value;
      array[3 * i + 1] = cyclic ? Math.sin(phase) : 0;
      array[3 * i + 2] = known ? 1 : 0;
    }
    data.needsUpdate = true;
  }
}

/** Pairs of vertices that share a side of a face, each once. */
function edgesOf(faces: Uint32Array): Uint32Array {
  const n = faces.reduce((most, vertex) => Math.max(most, vertex), 0) + 1;
  const seen = new Set<number>();
  const edges: number[] = [];
  for (let face = 0; face < faces.length; face += 3)
    for (let side = 0; side < 3; side += 1) {
      const from = faces[face + side];
      const to = faces[face + ((side + 1) % 3)];
      const key = Math.min(from, to) * n + Math.max(from, to);
      if (seen.has(key)) continue;
      seen.add(key);
      edges.push(from, to);
    }
  return Uint32Array.from(edges);
}
