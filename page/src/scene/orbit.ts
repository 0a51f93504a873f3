/** An orthographic camera that turns about a centre, and the hands and keys that move it. */
import { Matrix4, OrthographicCamera, Quaternion, Vector3 } from "three";

import type { Direction } from "./directions";

export interface Outlook {
  readonly turn: readonly [number, number, number, number];
  readonly centre: readonly [number, number, number];
  readonly halfHeight: number;
}

const X = new Vector3(1, 0, 0);
const Y = new Vector3(0, 1, 0);
const Z = new Vector3(0, 0, 1);

export class Orbit {
  readonly camera = new OrthographicCamera();
  /** The camera's axes in the surface's: right, up, towards the viewer. */
  readonly turn = new Quaternion();
  readonly centre = new Vector3();
  /** Half the height of the picture, mm. */
  halfHeight = 50;
  private radius = 50;
  private home: Outlook = this.outlook;

  /** Looks at all of a surface from the present direction. */
  fit(positions: Float32Array): void {
    const low = new Vector3(Infinity, Infinity, Infinity);
    const high = new Vector3(-Infinity, -Infinity, -Infinity);
    const at = new Vector3();
    for (let i = 0; i < positions.length; i += 3) {
      at.fromArray(positions, i);
      low.min(at);
      high.max(at);
    }
    this.centre.addVectors(low, high).multiplyScalar(0.5);
    let farthest = 0;
    for (let i = 0; i < positions.length; i += 3)
      farthest = Math.max(farthest, at.fromArray(positions, i).distanceTo(this.centre));
    this.radius = farthest || 1;
    this.halfHeight = this.radius * 1.05;
    this.home = this.outlook;
  }

  look(from: Direction): void {
    const right = new Vector3(...from.right);
    const up = new Vector3(...from.up);
    const axes = new Matrix4().makeBasis(right, up, new Vector3().crossVectors(right, up));
    this.turn.setFromRotationMatrix(axes);
  }

  /** Turns by angles about the picture's vertical and horizontal, radians. */
  rotate(about: number, over: number): void {
    this.turn.multiply(new Quaternion().setFromAxisAngle(Y, -about));
    this.turn.multiply(new Quaternion().setFromAxisAngle(X, -over)).normalize();
  }

  /** Shifts the picture by shares of its half height. */
  pan(right: number, up: number): void {
    const shift = new Vector3(-right, -up, 0).multiplyScalar(this.halfHeight);
    this.centre.add(shift.applyQuaternion(this.turn));
  }

  zoom(factor: number): void {
    const next = this.halfHeight / factor;
    this.halfHeight = Math.min(Math.max(next, this.radius / 100), this.radius * 10);
  }

  reset(): void {
    const turn = this.turn.clone();
    this.outlook = this.home;
    this.turn.copy(turn);
  }

  get outlook(): Outlook {
    return {
      turn: this.turn.toArray() as [number, number, number, number],
      centre: this.centre.toArray(),
      halfHeight: this.halfHeight,
    };
  }

  set outlook(outlook: Outlook) {
    this.turn.fromArray([...outlook.turn]).normalize();
    this.centre.fromArray([...outlook.centre]);
    this.halfHeight = outlook.halfHeight;
  }

  /** The camera for a picture of this shape. */
  placed(width: number, height: number): OrthographicCamera {
    const camera = this.camera;
    const tall = this.halfHeight * Math.max(1, height / Math.max(width, 1));
    const wide = (tall * width) / Math.max(height, 1);
    Object.assign(camera, { left: -wide, right: wide, top: tall, bottom: -tall });
    const away = this.radius * 12;
    camera.near = 0;
    camera.far = 2 * away;
    camera.quaternion.copy(this.turn);
    camera.position.copy(Z).applyQuaternion(this.turn).multiplyScalar(away).add(this.centre);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    return camera;
  }
}
