/**
 * What a page shows. Distances are reciprocals 1/s, in 1/length: 0 is infinitely far.
 *
 * @typedef {object} StackData The pictures of one aperture at all focus distances.
 * @property {string} aperture
 * @property {boolean} isPainted Whether it is focused as painted, or by the ordinary lens.
 * @property {number[]} inverseDistances Ascending: from the farthest slice to the nearest.
 * @property {(number | null)[]} bases The slice that each is the difference from; `null`: it is whole.
 * @property {(string | null)[]} slices WebP in base 122; `null` for the one that the poster shows.
 *
 * @typedef {object} MapData Packed maps of one byte a pixel (`PixelMap`).
 * @property {[number, number]} size Columns and rows.
 * @property {string | null} sharpDistances Which distance makes a pixel sharp, for the ordinary lens.
 * @property {string | null} paintedSharpDistances The same, as painted.
 * @property {string | null} paint How the paint blurs.
 *
 * @typedef {object} PageData
 * @property {string} title
 * @property {[number, number]} size Columns and rows.
 * @property {{stack: number, slice: number}} opening What is shown first.
 * @property {StackData[]} stacks
 * @property {[number, number]} range The farthest and the nearest distance.
 * @property {MapData} maps
 * @property {boolean} autoplays
 */
