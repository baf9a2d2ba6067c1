/**
 * Where the focus is, and how pointers and the player move it.
 *
 * @typedef {object} Racking
 * @property {number} farthest The reciprocal of the farthest distance.
 * @property {number} nearest
 * @property {number} inverseDistance
 * @property {number} position 0 at the nearest distance, 1 at the farthest.
 * @property {(position: number) => void} move Moves to a position, and may move on.
 * @property {() => void} settle Rests where it is.
 */

/**
 * The element with an id, which the page has.
 *
 * @template {typeof HTMLElement} T
 * @param {string} id
 * @param {T} type
 * @returns {InstanceType<T>}
 */
function element(id, type) {
  const found = document.getElementById(id);
  if (!(found instanceof type)) throw new Error(`the page has no ${id}`);
  return /** @type {InstanceType<T>} */ (found);
}

/**
 * @param {number} x
 * @param {number} low
 * @param {number} high
 */
function clamp(x, low, high) {
  return Math.min(Math.max(x, low), high);
}

/**
 * A distance as text: three digits, in metres.
 *
 * @param {number} inverseDistance
 */
function distanceText(inverseDistance) {
  const distance = Number((1 / inverseDistance).toPrecision(3));
  return distance < 1e5 ? `${distance} m` : "∞";
}
