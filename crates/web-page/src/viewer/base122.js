/** Seven bits that would need escaping: NUL, ends of lines, ", < and \. */
const JOINED_GROUPS = [0, 10, 13, 34, 60, 92];
/** The first code of characters that are one of these, with none after it. */
const ALONE = (1 + JOINED_GROUPS.length) << 7;

/**
 * Bytes of text: ASCII holds seven bits, another character those above and, but for the last, seven more.
 *
 * @param {string} text
 * @returns {Uint8Array}
 */
function decodeBase122(text) {
  const bytes = new Uint8Array((14 * text.length) >> 3);
  let [bits, count, length] = [0, 0, 0];
  for (let k = 0; k < text.length; k++) {
    const code = text.charCodeAt(k);
    const isPair = code >= 128 && code < ALONE;
    const group = code < 128 ? code : JOINED_GROUPS[isPair ? (code >> 7) - 1 : code - ALONE];
    bits |= (isPair ? group | ((code & 127) << 7) : group) << count;
    count += isPair ? 14 : 7;
    while (count >= 8) {
      bytes[length++] = bits;
      bits >>>= 8;
      count -= 8;
    }
  }
  return bytes.slice(0, length);
}

/**
 * Compressed bytes of text, decompressed; `null` where the browser cannot.
 *
 * @param {string} text
 * @returns {Promise<Uint8Array | null>}
 */
async function inflate(text) {
  // Newer than the browser types of TypeScript 4.8, and than Safari 16.3.
  const { DecompressionStream } = /** @type {any} */ (window);
  if (!DecompressionStream) return null;
  const stream = new Blob([decodeBase122(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
