/** The characters of base 91: those of ASCII from ! to ~ without ", < and \. */
const BASE91 = "!#$%&'()*+,-./0123456789:;=>?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[]^_`abcdefghijklmnopqrstuvwxyz{|}~";

/**
 * Bytes of text: two characters hold 13 bits, a single last one holds six.
 *
 * @param {string} text
 * @returns {Uint8Array}
 */
function decodeBase91(text) {
  const numbers = new Uint8Array(128);
  for (let k = 0; k < 91; k++) numbers[BASE91.charCodeAt(k)] = k;
  const pairs = text.length >> 1;
  const bytes = new Uint8Array((13 * pairs + 6 * (text.length & 1)) >> 3);
  let [bits, count, length] = [0, 0, 0];
  for (let k = 0; k < text.length; k += 2) {
    const isPair = k + 1 < text.length;
    const high = isPair ? numbers[text.charCodeAt(k + 1)] : 0;
    bits |= (numbers[text.charCodeAt(k)] + 91 * high) << count;
    count += isPair ? 13 : 6;
    while (count >= 8) {
      bytes[length++] = bits;
      bits >>>= 8;
      count -= 8;
    }
  }
  return bytes;
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
  const stream = new Blob([decodeBase91(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
