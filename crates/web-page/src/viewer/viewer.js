/**
 * Shows a page. The poster is on the screen already; it stays until the first slice is drawn.
 *
 * @param {PageData} page
 */
function showPage(page) {
  const viewer = element("viewer", HTMLElement);
  const view = element("view", HTMLDivElement);
  const canvas = element("screen", HTMLCanvasElement);
  const poster = element("poster", HTMLImageElement);
  const message = new Message();
  const { maps } = page;

  const rack = new Rack(page, () => {
    controls.update();
    draw();
  });
  const slices = new SliceCache(page.stacks, poster);
  const screen = new PictureScreen(canvas, slices, rack, () => {
    poster.remove();
    const { aperture, isPainted } = page.stacks[rack.stack];
    const distance = distanceText(rack.inverseDistance);
    canvas.setAttribute("aria-label", `${page.title}: focused at ${distance}, ${aperture}${isPainted ? ", as painted" : ""}`);
    viewer.dataset.drawn = screen.drawn;
    viewer.dataset.inverseDistance = String(rack.inverseDistance);
  });
  /** @type {Player} */
  const player = new Player(rack, (isPlaying) => controls.focusBar.showPlaying(isPlaying));
  /** @type {Controls} */
  const controls = new Controls(page, rack, player);
  const zoom = new Zoom(view, element("stage", HTMLDivElement));
  const gestures = new Gestures(view, zoom, rack, { begin, aim, click: focusOn });
  addEventListener("resize", () => zoom.apply());

  const sharpDistances = unpackMap(maps.size, maps.sharpDistances);
  const paintedSharpDistances = unpackMap(maps.size, maps.paintedSharpDistances);
  unpackMap(maps.size, maps.paint).then((paint) => paint && drawTint(controls.tint, paint));

  function draw() {
    screen.draw().catch(() => message.show("This browser cannot show the pictures of this page (WebP)"));
  }

  /** Somebody touches the page. */
  function begin() {
    player.stop();
    element("hint", HTMLParagraphElement).classList.add("done");
  }

  const distanceMap = () => (page.stacks[rack.stack].isPainted ? paintedSharpDistances : sharpDistances);

  /**
   * The reciprocal distance that makes sharp what is at a point of the window; `null` where none does, `undefined` beside the picture.
   *
   * @param {{clientX: number, clientY: number}} point
   */
  async function sharpDistance(point) {
    const [x, y] = zoom.place(point);
    const map = await distanceMap();
    return map && x >= 0 && x < 1 && y >= 0 && y < 1 ? distanceOfCode(map.at(x, y), page.range) : undefined;
  }

  let aiming = 0;

  /**
   * Decodes what a click at a point would show, unless something else is aimed at before.
   *
   * @param {{clientX: number, clientY: number}} point
   * @param {number} wait ms
   */
  function aim(point, wait) {
    clearTimeout(aiming);
    aiming = setTimeout(async () => {
      const distance = await sharpDistance(point);
      if (typeof distance === "number") slices.get(rack.stack, rack.sliceAt(distance)).catch(() => {});
    }, wait);
  }

  /**
   * Focuses on what is at a point of the window.
   *
   * @param {{clientX: number, clientY: number}} point
   */
  async function focusOn(point) {
    if (!(await distanceMap())) message.show("This browser cannot focus by a click: drag from side to side");
    const inverseDistance = await sharpDistance(point);
    if (inverseDistance === undefined) return;
    showMark(view, point, inverseDistance !== null);
    if (inverseDistance === null) {
      message.show("Painted, stays so");
    } else {
      rack.rest(inverseDistance);
      message.speak(`Focused at ${distanceText(rack.inverseDistance)}`);
    }
  }

  /** @type {{[key: string]: () => void}} */
  const actions = {
    ArrowLeft: () => rack.step(-1),
    ArrowRight: () => rack.step(1),
    Home: () => rack.rest(rack.nearest),
    End: () => rack.rest(rack.farthest),
    "+": () => gestures.magnifyMiddle(1.25),
    "=": () => gestures.magnifyMiddle(1.25),
    "-": () => gestures.magnifyMiddle(0.8),
    0: () => gestures.magnifyMiddle(0),
    "[": () => controls.stepAperture(-1),
    "]": () => controls.stepAperture(1),
    p: () => controls.toggleKind(),
    t: () => controls.togglePaint(),
    f: toggleFullScreen,
    " ": () => player.toggle(),
    Enter: () => focusOn(zoom.middle),
  };

  addEventListener("keydown", (event) => {
    const { target, key } = event;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    // Buttons are pressed by space and enter, radio buttons chosen by arrows; the slider has no use for either.
    const isButton = target instanceof HTMLButtonElement && (key === " " || key === "Enter");
    const isChoice = target instanceof HTMLInputElement && target.type === "radio" && /^(Arrow|Home|End| )/.test(key);
    const action = actions[key.length === 1 ? key.toLowerCase() : key];
    if (isButton || isChoice || !action) return;
    event.preventDefault();
    // Space stops a rack by itself.
    if (key !== " ") begin();
    action();
  });

  draw();
  if (page.autoplays && !matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();
}
