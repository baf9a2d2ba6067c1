/** A pointer that moves less than this, px, clicks. */
const CLICK_PX = 6;
/** A mouse that rests for so long, ms, may be about to click. */
const REST_MS = 40;
/** How much a pixel of the wheel magnifies, as a logarithm. */
const WHEEL_ZOOM = 0.002;

/**
 * Turns what pointers and wheel do on the picture into actions: a click focuses, a drag racks, the wheel and two fingers zoom;
 * with the shift key or the middle button a drag moves the picture. While a brush is active, clicks and drags paint.
 */
class Gestures {
  /**
   * @param {HTMLElement} view
   * @param {Zoom} zoom
   * @param {Racking} rack
   * @param {{begin: () => void, aim: (point: PointerEvent, wait: number) => void, click: (point: PointerEvent) => void}} actions
   * @param {{isActive: boolean, begin: (point: PointerEvent) => void, extend: (point: PointerEvent) => void, end: () => void} | null} brush
   */
  constructor(view, zoom, rack, actions, brush = null) {
    this.view = view;
    this.zoom = zoom;
    this.rack = rack;
    this.actions = actions;
    this.brush = brush;
    /** @type {Map<number, PointerEvent>} The pointers that are down, and where they were last. */
    this.pointers = new Map();
    /** @type {"click" | "rack" | "pan" | "pinch" | "paint"} */
    this.kind = "click";
    this.startX = 0;
    this.startY = 0;
    this.startPosition = 0;
    this.isFramed = window.parent !== window;
    view.addEventListener("pointerdown", (event) => this.down(event));
    view.addEventListener("pointermove", (event) => this.move(event));
    view.addEventListener("pointerup", (event) => this.up(event));
    view.addEventListener("pointercancel", (event) => this.cancel(event));
    view.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.allowScrolling();
  }

  /** In a frame, a finger that moves up or down scrolls the page around it, unless the picture is magnified. */
  allowScrolling() {
    this.view.style.touchAction = this.isFramed && this.zoom.scale === 1 ? "pan-y" : "none";
  }

  /** @param {number} factor */
  magnifyMiddle(factor) {
    this.zoom.magnify(factor, this.zoom.middle);
    this.allowScrolling();
  }

  /** @param {PointerEvent} event */
  down(event) {
    if (event.button > 1) return;
    this.actions.begin();
    this.view.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, event);
    if (this.pointers.size > 1) {
      this.finish();
      this.kind = "pinch";
      return;
    }
    if (event.button === 1) event.preventDefault();
    if (this.brush && this.brush.isActive && event.button === 0 && !event.shiftKey) {
      this.kind = "paint";
      this.brush.begin(event);
      return;
    }
    this.actions.aim(event, 0);
    this.kind = event.shiftKey || event.button === 1 ? "pan" : "click";
    [this.startX, this.startY, this.startPosition] = [event.clientX, event.clientY, this.rack.position];
  }

  /** @param {PointerEvent} event */
  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      if (!event.buttons) this.actions.aim(event, REST_MS);
    } else if (this.kind === "pinch") {
      this.pinch(before, event);
    } else if (this.kind === "paint") {
      if (this.brush) this.brush.extend(event);
    } else if (this.kind === "pan") {
      this.zoom.pan(event.clientX - before.clientX, event.clientY - before.clientY);
    } else {
      const [x, y] = [event.clientX - this.startX, event.clientY - this.startY];
      if (this.kind === "click" && Math.hypot(x, y) >= CLICK_PX) this.kind = "rack";
      if (this.kind === "rack") this.rack.move(this.startPosition + x / this.zoom.frame.width);
    }
    if (before) this.pointers.set(event.pointerId, event);
  }

  /**
   * @param {PointerEvent} before
   * @param {PointerEvent} now
   */
  pinch(before, now) {
    const other = [...this.pointers.values()].find((pointer) => pointer.pointerId !== now.pointerId);
    if (!other) return;
    /** @type {(pointer: PointerEvent) => number} */
    const apart = (pointer) => Math.hypot(pointer.clientX - other.clientX, pointer.clientY - other.clientY);
    this.zoom.pan((now.clientX - before.clientX) / 2, (now.clientY - before.clientY) / 2);
    const middle = { clientX: (now.clientX + other.clientX) / 2, clientY: (now.clientY + other.clientY) / 2 };
    this.zoom.magnify(apart(now) / Math.max(apart(before), 1), middle);
    this.allowScrolling();
  }

  /** @param {PointerEvent} event */
  up(event) {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.kind === "click") this.actions.click(event);
    this.finish();
  }

  /** @param {PointerEvent} event */
  cancel(event) {
    if (this.pointers.delete(event.pointerId)) this.finish();
  }

  /** What was dragged or painted is done. */
  finish() {
    if (this.kind === "paint" && this.brush) this.brush.end();
    this.rack.settle();
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    // In a frame the wheel scrolls the page around it until somebody uses this one, and wherever there is nothing to reduce.
    const isOthers = this.isFramed && !event.ctrlKey && !document.hasFocus();
    if (isOthers || (this.isFramed && event.deltaY > 0 && this.zoom.scale === 1)) return;
    event.preventDefault();
    this.actions.begin();
    const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : 32);
    // A pinch on a touchpad arrives as a wheel with the control key, in small steps.
    const factor = Math.exp(-clamp(pixels, -300, 300) * WHEEL_ZOOM * (event.ctrlKey ? 5 : 1));
    this.zoom.magnify(factor, event);
    this.allowScrolling();
  }
}
