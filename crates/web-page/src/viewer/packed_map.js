/**
 * Unpacks a map: compressed differences of each byte from its left neighbour. `null` without one, or where the browser cannot decompress.
 *
 * @param {[number, number]} size
 * @param {string | null} packed
 * @returns {Promise<PixelMap | null>}
 */
async function unpackMap(size, packed) {
  const codes = packed === null ? null : await inflate(packed);
  if (!codes) return null;
  for (let first = 0; first < codes.length; first += size[0]) {
    for (let k = first + 1; k < first + size[0]; k++) codes[k] += codes[k - 1];
  }
  return new PixelMap(size, codes);
}
