/** The widest aperture by the narrowest. */
const APERTURE_RATIO = 32;

/** The lens: where it is focused, how far it is opened, and the shape of its aperture. */
class LensRack {
  /**
   * @param {EngineExports} engine
   * @param {() => void} onChange
   */
  constructor(engine, onChange) {
    this.farthest = engine.farthest();
    this.nearest = engine.nearest();
    this.inverseDistance = engine.exported_distance();
    this.widestFNumber = engine.exported_f_number();
    /** The aperture radius as a share of the widest. */
    this.apertureShare = 1;
    /** 0: as exported, 1: a disc, else the number of blades. */
    this.blades = 0;
    /** Whether it focuses as painted, or as an ordinary lens. */
    this.isPainted = true;
    this.isMoving = false;
    this.onChange = onChange;
  }

  /** 0 at the nearest distance, 1 at the farthest. */
  get position() {
    const extent = this.nearest - this.farthest;
    return extent > 0 ? clamp((this.nearest - this.inverseDistance) / extent, 0, 1) : 0;
  }

  /** 0 with the aperture wide open, 1 with the narrowest. */
  get stop() {
    return -Math.log(this.apertureShare) / Math.log(APERTURE_RATIO);
  }

  get fNumberText() {
    return `f/${Number((this.widestFNumber / this.apertureShare).toPrecision(3))}`;
  }

  /** @param {number} inverseDistance */
  rest(inverseDistance) {
    this.inverseDistance = Math.max(inverseDistance, 0);
    this.isMoving = false;
    this.onChange();
  }

  /** @param {number} position */
  move(position) {
    this.inverseDistance = this.nearest - clamp(position, 0, 1) * (this.nearest - this.farthest);
    this.isMoving = true;
    this.onChange();
  }

  settle() {
    if (!this.isMoving) return;
    this.isMoving = false;
    this.onChange();
  }

  /**
   * Goes a share of the range farther, and rests there.
   *
   * @param {number} share Negative: nearer.
   */
  step(share) {
    this.move(this.position + share);
    this.settle();
  }

  /**
   * @param {number} stop From 0 with the aperture wide open to 1.
   * @param {boolean} isMoving Whether it may move on.
   */
  stopDown(stop, isMoving) {
    this.apertureShare = APERTURE_RATIO ** -clamp(stop, 0, 1);
    this.isMoving = isMoving;
    this.onChange();
  }

  /** @param {boolean} isPainted */
  showPaint(isPainted) {
    this.isPainted = isPainted;
    this.onChange();
  }

  /** @param {number} blades */
  shape(blades) {
    this.blades = blades;
    this.onChange();
  }
}
