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

/** Shows the button for the full screen where it is allowed. */
function showFullScreenButton() {
  const button = element("full-screen", HTMLButtonElement);
  button.hidden = !document.fullscreenEnabled;
  button.addEventListener("click", toggleFullScreen);
}

function toggleFullScreen() {
  const changed = document.fullscreenElement
    ? document.exitFullscreen()
    : document.documentElement.requestFullscreen();
  changed.catch(() => {});
}
