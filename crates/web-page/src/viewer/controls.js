/** Time of a rack from near to far and back, ms. */
const RACK_PERIOD = 9000;
/** How long a message stays, ms. */
const MESSAGE_TIME = 3000;

/** Racks the focus back and forth. */
class Player {
  /**
   * @param {Rack} rack
   * @param {(isPlaying: boolean) => void} onChange
   */
  constructor(rack, onChange) {
    this.rack = rack;
    this.onChange = onChange;
    /** The number of the requested frame; 0 while nothing plays. */
    this.frame = 0;
  }

  get isPlaying() {
    return this.frame !== 0;
  }

  play() {
    if (this.isPlaying) return;
    // From where the focus is, toward the far end.
    const phase = Math.acos(1 - 2 * this.rack.position);
    /** @type {number | null} */
    let start = null;
    /** @param {number} time */
    const step = (time) => {
      start ??= time;
      this.frame = requestAnimationFrame(step);
      this.rack.move((1 - Math.cos(phase + (2 * Math.PI * (time - start)) / RACK_PERIOD)) / 2);
    };
    this.frame = requestAnimationFrame(step);
    this.onChange(true);
  }

  stop() {
    if (!this.isPlaying) return;
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.rack.settle();
    this.onChange(false);
  }
}

/** A message over the picture, which screen readers speak. */
class Message {
  constructor() {
    this.paragraph = element("message", HTMLParagraphElement);
    this.timer = 0;
  }

  /** @param {string} text */
  show(text) {
    this.speak(text);
    this.paragraph.classList.remove("spoken");
  }

  /**
   * Tells screen readers alone what others see.
   *
   * @param {string} text
   */
  speak(text) {
    clearTimeout(this.timer);
    this.paragraph.classList.add("spoken");
    this.paragraph.textContent = text;
    this.timer = setTimeout(() => (this.paragraph.textContent = ""), MESSAGE_TIME);
  }
}

/**
 * Fills a group with a radio button for each choice, and returns the buttons.
 *
 * @param {string} id Of the group.
 * @param {string[]} labels
 * @param {(index: number) => void} onChoice
 * @returns {HTMLInputElement[]}
 */
function addChoices(id, labels, onChoice) {
  const group = element(id, HTMLDivElement);
  return labels.map((text, index) => {
    const label = document.createElement("label");
    const input = document.createElement("input");
    const span = document.createElement("span");
    label.className = "choice";
    input.type = "radio";
    input.name = id;
    input.addEventListener("change", () => onChoice(index));
    span.textContent = text;
    label.append(input, span);
    group.append(label);
    return input;
  });
}

/** The bar below the picture. It shows what the rack shows. */
class Controls {
  /**
   * @param {PageData} page
   * @param {Rack} rack
   * @param {Player} player
   */
  constructor(page, rack, player) {
    const { stacks } = page;
    this.rack = rack;
    this.player = player;
    this.apertures = [...new Set(stacks.map((stack) => stack.aperture))];
    this.kinds = [true, false].filter((isPainted) => stacks.some((stack) => stack.isPainted === isPainted));
    this.distance = element("distance", HTMLInputElement);
    this.distanceText = element("distance-text", HTMLOutputElement);
    this.distance.addEventListener("input", () => {
      player.stop();
      rack.move(Number(this.distance.value));
    });
    this.distance.addEventListener("change", () => rack.settle());
    this.apertureInputs = addChoices("apertures", this.apertures, (index) => this.chooseAperture(index));
    const names = this.kinds.map((isPainted) => (isPainted ? "Painted" : "Ordinary lens"));
    this.kindInputs = addChoices("focusing", names, (index) => this.chooseKind(this.kinds[index]));
    element("focusing", HTMLDivElement).hidden = this.kinds.length < 2;
    element("rack", HTMLDivElement).hidden = rack.nearest === rack.farthest;
    this.playButton = element("play", HTMLButtonElement);
    this.playButton.addEventListener("click", () => this.togglePlaying());
    this.paintButton = element("show-paint", HTMLButtonElement);
    this.paintButton.hidden = page.maps.paint === null;
    this.tint = element("tint", HTMLCanvasElement);
    this.paintButton.addEventListener("click", () => this.togglePaint());
    const fullScreen = element("full-screen", HTMLButtonElement);
    fullScreen.hidden = !document.fullscreenEnabled;
    fullScreen.addEventListener("click", () => this.toggleFullScreen());
    element("bar", HTMLDivElement).hidden = false;
    this.update();
  }

  /** Shows the state of the rack. */
  update() {
    const { rack } = this;
    const stack = rack.stacks[rack.stack];
    const text = distanceText(rack.inverseDistance);
    this.distance.value = String(rack.position);
    this.distance.setAttribute("aria-valuetext", text);
    this.distanceText.value = text;
    this.apertures.forEach((aperture, index) => {
      const input = this.apertureInputs[index];
      input.checked = aperture === stack.aperture;
      input.disabled = !rack.stacks.some((s) => s.aperture === aperture && s.isPainted === stack.isPainted);
    });
    this.kinds.forEach((isPainted, index) => (this.kindInputs[index].checked = isPainted === stack.isPainted));
  }

  /** @param {boolean} isPlaying */
  showPlaying(isPlaying) {
    this.playButton.setAttribute("aria-pressed", String(isPlaying));
  }

  togglePlaying() {
    if (this.player.isPlaying) this.player.stop();
    else this.player.play();
  }

  /** @param {number} index */
  chooseAperture(index) {
    const { rack } = this;
    rack.choose(rack.find(this.apertures[index], rack.stacks[rack.stack].isPainted));
  }

  /**
   * The next aperture that there is.
   *
   * @param {number} step 1: smaller, −1: wider.
   */
  stepAperture(step) {
    const current = this.apertures.indexOf(this.rack.stacks[this.rack.stack].aperture);
    const next = this.apertureInputs[current + step];
    if (next && !next.disabled) this.chooseAperture(current + step);
  }

  /** @param {boolean} isPainted */
  chooseKind(isPainted) {
    this.rack.choose(this.rack.find(this.rack.stacks[this.rack.stack].aperture, isPainted));
  }

  toggleKind() {
    if (this.kinds.length > 1) this.chooseKind(!this.rack.stacks[this.rack.stack].isPainted);
  }

  togglePaint() {
    if (this.paintButton.hidden) return;
    this.tint.hidden = !this.tint.hidden;
    this.paintButton.setAttribute("aria-pressed", String(!this.tint.hidden));
  }

  toggleFullScreen() {
    const changed = document.fullscreenElement
      ? document.exitFullscreen()
      : document.documentElement.requestFullscreen();
    changed.catch(() => {});
  }
}
