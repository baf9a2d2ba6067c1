/**
 * Draws a ring at a point of the window.
 *
 * @param {HTMLElement} view
 * @param {{clientX: number, clientY: number}} point
 * @param {boolean} hasFocused
 */
function showMark(view, { clientX, clientY }, hasFocused) {
  const mark = element("mark", HTMLDivElement);
  const { left, top } = view.getBoundingClientRect();
  mark.hidden = true;
  mark.classList.toggle("unchanged", !hasFocused);
  mark.style.left = `${clientX - left}px`;
  mark.style.top = `${clientY - top}px`;
  // Read, so that the animation starts anew.
  void mark.offsetWidth;
  mark.hidden = false;
}
