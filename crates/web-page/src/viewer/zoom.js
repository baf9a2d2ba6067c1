/** The largest magnification. */
const MOST_ZOOM = 16;

/** The part of the picture that is shown. The stage is scaled about its upper left corner, then moved. */
class Zoom {
  /**
   * @param {HTMLElement} view What the stage lies in.
   * @param {HTMLElement} stage The picture.
   */
  constructor(view, stage) {
    this.view = view;
    this.stage = stage;
    this.scale = 1;
    this.x = 0;
    this.y = 0;
  }

  /** Where the picture lies unscaled, relative to the view. */
  get frame() {
    const { offsetLeft: left, offsetTop: top, offsetWidth: width, offsetHeight: height } = this.stage;
    return { left, top, width, height };
  }

  /** The middle of the view, as a point of the window. */
  get middle() {
    const { left, top, width, height } = this.view.getBoundingClientRect();
    return { clientX: left + width / 2, clientY: top + height / 2 };
  }

  /**
   * Where a point of the window lies in the picture: from 0 at the upper left to 1.
   *
   * @param {{clientX: number, clientY: number}} point
   * @returns {[number, number]}
   */
  place({ clientX, clientY }) {
    const { left, top, width, height } = this.stage.getBoundingClientRect();
    return [(clientX - left) / width, (clientY - top) / height];
  }

  /**
   * Magnifies about a point of the window.
   *
   * @param {number} factor
   * @param {{clientX: number, clientY: number}} point
   */
  magnify(factor, point) {
    const [x, y] = this.place(point);
    const { width, height } = this.frame;
    const scale = clamp(this.scale * factor, 1, MOST_ZOOM);
    this.x -= x * width * (scale - this.scale);
    this.y -= y * height * (scale - this.scale);
    this.scale = scale;
    this.apply();
  }

  /**
   * Moves the picture by some pixels of the window.
   *
   * @param {number} x
   * @param {number} y
   */
  pan(x, y) {
    this.x += x;
    this.y += y;
    this.apply();
  }

  /** Keeps the picture over the view, or in its middle where it is smaller. */
  apply() {
    const { left, top, width, height } = this.frame;
    /** @type {(offset: number, start: number, side: number, room: number) => number} */
    const limit = (offset, start, side, room) => {
      const least = room - start - side * this.scale;
      return least < -start ? clamp(offset, least, -start) : (least - start) / 2;
    };
    this.x = limit(this.x, left, width, this.view.clientWidth);
    this.y = limit(this.y, top, height, this.view.clientHeight);
    this.stage.style.transform = this.scale > 1 ? `translate(${this.x}px, ${this.y}px) scale(${this.scale})` : "";
  }
}
