/**
 * What a page of the engine shows.
 *
 * @typedef {object} EngineData
 * @property {string} title
 * @property {string} program The WebAssembly module, compressed, in base 122.
 * @property {string} field The light field, likewise.
 * @property {object} view In which strokes are recorded.
 * @property {boolean} hasDisc Whether the exported aperture is a plain disc.
 * @property {boolean} isPainted Whether it has paint.
 * @property {boolean} autoplays
 */

/**
 * The functions of the module. Distances are reciprocals, in 1/length; places of the picture go from 0 at the upper left to 1.
 * Those that can fail return 1, and there is a message.
 *
 * @typedef {object} EngineExports
 * @property {WebAssembly.Memory} memory
 * @property {(bytes: number) => number} make_room
 * @property {() => number} open
 * @property {() => number} message_start
 * @property {() => number} message_length
 * @property {() => number} farthest
 * @property {() => number} nearest
 * @property {() => number} exported_distance
 * @property {() => number} exported_f_number
 * @property {(inverseDistance: number, apertureShare: number, blades: number, isPainted: number, isDraft: number) => number} refocus
 * @property {() => number} paint_map
 * @property {() => number} pixels_start
 * @property {() => number} columns
 * @property {() => number} rows
 * @property {(x: number, y: number) => number} sharp_distance
 * @property {(x: number, y: number, radiusPx: number, hardness: number, circlePx: number) => number} begin_stroke
 * @property {() => number} stroke_radius
 * @property {() => number} stroke_t
 * @property {(x: number, y: number) => void} extend_stroke
 * @property {() => number} draw_stroke
 * @property {() => number} end_stroke
 * @property {() => number} undo
 * @property {() => number} redo
 */
