/** The groups of seven bits that are no character of their own, since they would need escaping: NUL, the ends of lines, ", < and \. */
const JOINED_GROUPS = [0, 10, 13, 34, 60, 92];
/** The first code of characters that are one of these groups, with none after it. */
const ALONE = (1 + JOINED_GROUPS.length) << 7;

/**
 * Bytes of text: a character of ASCII holds seven bits, another one those of a group above and, unless it is the last, seven more.
 *
 * @param {string} text
 * @returns {Uint8Array}
 */
function decodeBase122(text) {
  const bytes = new Uint8Array((14 * text.length) >> 3);
  let [bits, count, length] = [0, 0, 0];
  /** @param {number} group */
  const take = (group) => {
    bits |= group << count;
    count += 7;
    if (count >= 8) {
      bytes[length++] = bits;
      bits >>>= 8;
      count -= 8;
    }
  };
  for (let k = 0; k < text.length; k++) {
    const code = text.charCodeAt(k);
    if (code < 128) {
      take(code);
    } else if (code >= ALONE) {
      take(JOINED_GROUPS[code - ALONE]);
    } else {
      take(JOINED_GROUPS[(code >> 7) - 1]);
      take(code & 127);
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
