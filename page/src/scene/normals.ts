/** Normals of a surface's vertices, weighted by the area of the faces around them. */
export function vertexNormals(positions: Float32Array, faces: Uint32Array, into: Float32Array): void {
  into.fill(0);
  for (let face = 0; face < faces.length; face += 3) {
    const a = 3 * faces[face];
    const b = 3 * faces[face + 1];
    const c = 3 * faces[face + 2];
    const ux = positions[b] - positions[a];
    const uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a];
    const vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    into[a] += x;
    into[a + 1] += y;
    into[a + 2] += z;
    into[b] += x;
    into[b + 1] += y;
    into[b + 2] += z;
    into[c] += x;
    into[c + 1] += y;
    into[c + 2] += z;
  }
}
