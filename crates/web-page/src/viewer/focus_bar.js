/** The controls of the focus: slider, distance, and the button that racks. */
class FocusBar {
  /**
   * @param {Racking} rack
   * @param {Player} player
   */
  constructor(rack, player) {
    this.rack = rack;
    this.slider = element("distance", HTMLInputElement);
    this.text = element("distance-text", HTMLOutputElement);
    this.playButton = element("play", HTMLButtonElement);
    this.slider.addEventListener("input", () => {
      player.stop();
      rack.move(Number(this.slider.value));
    });
    this.slider.addEventListener("change", () => rack.settle());
    this.playButton.addEventListener("click", () => player.toggle());
    element("rack", HTMLDivElement).hidden = rack.nearest === rack.farthest;
  }

  /** Shows the state of the rack. */
  update() {
    const text = distanceText(this.rack.inverseDistance);
    this.slider.value = String(this.rack.position);
    this.slider.setAttribute("aria-valuetext", text);
    this.text.value = text;
  }

  /** @param {boolean} isPlaying */
  showPlaying(isPlaying) {
    this.playButton.setAttribute("aria-pressed", String(isPlaying));
  }
}
