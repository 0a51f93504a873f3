/** Mouse, touch and keys on a picture: turning, shifting, zooming, clicking. */
import type { Orbit } from "./orbit";

const CLICK_PIXELS = 4;

export interface Handlers {
  /** The camera has moved. */
  moved(): void;
  /** A place was clicked, pixels from the picture's upper left corner. */
  clicked(x: number, y: number, event: PointerEvent): void;
  /** The pointer is over a place, or has left (null). */
  hovered(place: { x: number; y: number } | null): void;
}

/** Lets the user move `orbit` by hand on `element`. */
export function takeInHand(element: HTMLElement, orbit: Orbit, on: Handlers): void {
  const pointers = new Map<number, PointerEvent>();
  let travelled = 0;

  const local = (event: PointerEvent): { x: number; y: number } => {
    const box = element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };

  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    if (pointers.size === 1) travelled = 0;
  });
  element.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) {
      on.hovered(local(event));
      return;
    }
    travelled += Math.hypot(event.clientX - before.clientX, event.clientY - before.clientY);
    if (travelled >= CLICK_PIXELS) drag(event, before);
    pointers.set(event.pointerId, event);
  });
  element.addEventListener("pointerleave", () => on.hovered(null));
  for (const end of ["pointerup", "pointercancel"] as const)
    element.addEventListener(end, (event) => {
      const known = pointers.delete(event.pointerId);
      if (end === "pointerup" && known && travelled < CLICK_PIXELS && event.button === 0)
        on.clicked(local(event).x, local(event).y, event);
    });
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      orbit.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
      on.moved();
    },
    { passive: false },
  );
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!keyed(event, orbit)) return;
    event.preventDefault();
    event.stopPropagation();
    on.moved();
  });

  function drag(event: PointerEvent, before: PointerEvent): void {
    const size = Math.min(element.clientWidth, element.clientHeight);
    const right = (event.clientX - before.clientX) / size;
    const down = (event.clientY - before.clientY) / size;
    if (pointers.size === 2) pinch(event, before, right, down);
    else if (event.shiftKey || event.buttons & 6) orbit.pan(2 * right, -2 * down);
    else orbit.rotate(Math.PI * right, Math.PI * down);
    on.moved();
  }

  function pinch(event: PointerEvent, before: PointerEvent, right: number, down: number): void {
    const other = [...pointers.values()].find((each) => each.pointerId !== event.pointerId);
    if (!other) return;
    const distance = (one: PointerEvent): number =>
      Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
    orbit.zoom(distance(event) / Math.max(distance(before), 1));
    orbit.pan(right, -down);
  }
}

const STEP = Math.PI / 36;
const ARROWS: Record<string, readonly [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

function keyed(event: KeyboardEvent, orbit: Orbit): boolean {
  const arrow = ARROWS[event.key];
  if (arrow && event.shiftKey) orbit.pan(0.1 * arrow[0], -0.1 * arrow[1]);
  else if (arrow) orbit.rotate(STEP * arrow[0], STEP * arrow[1]);
  else if (event.key === "+" || event.key === "=") orbit.zoom(1.15);
  else if (event.key === "-") orbit.zoom(1 / 1.15);
  else if (event.key === "r") orbit.reset();
  else return false;
  return true;
}
