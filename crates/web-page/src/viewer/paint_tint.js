/** The false colours of blur, as in the window: near, over sharp, to far; sRGB, equally spaced. */
const FALSE_COLORS = [
  [115, 38, 5],
  [204, 97, 13],
  [250, 181, 107],
  [240, 240, 237],
  [143, 196, 235],
  [51, 128, 204],
  [15, 56, 122],
];

/**
 * Draws how the paint blurs: 1 is nearest, 128 sharp, 255 farthest; 0, what is not painted, stays clear.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {PixelMap} paint
 */
function drawTint(canvas, paint) {
  const [width, height] = paint.size;
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d");
  if (!context) return;
  const image = context.createImageData(width, height);
  const colors = Array.from({ length: 256 }, (_, code) => falseColor((code - 128) / 127));
  paint.codes.forEach((code, k) => {
    if (code > 0) image.data.set([...colors[code], 255], 4 * k);
  });
  context.putImageData(image, 0, 0);
}

/**
 * @param {number} position From −1 to 1.
 */
function falseColor(position) {
  const last = FALSE_COLORS.length - 1;
  const at = ((clamp(position, -1, 1) + 1) / 2) * last;
  const index = Math.min(Math.floor(at), last - 1);
  return FALSE_COLORS[index].map((from, c) => Math.round(from + (FALSE_COLORS[index + 1][c] - from) * (at - index)));
}
