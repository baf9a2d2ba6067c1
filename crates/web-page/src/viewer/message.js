/** How long a message stays, ms. */
const MESSAGE_TIME = 3000;

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
