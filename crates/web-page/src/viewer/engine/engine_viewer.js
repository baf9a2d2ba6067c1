/**
 * Shows a page of the engine. The poster is on the screen already; it stays until the first picture is drawn.
 *
 * @param {EngineData} page
 */
async function showEnginePage(page) {
  const viewer = element("viewer", HTMLElement);
  const view = element("view", HTMLDivElement);
  const canvas = element("screen", HTMLCanvasElement);
  const poster = element("poster", HTMLImageElement);
  const message = new Message();
  /** @type {(error: unknown) => void} */
  const failed = (error) => message.show(error instanceof Error ? error.message : String(error));
  /** @type {Engine} */
  let engine;
  try {
    engine = await Engine.open(page);
  } catch (error) {
    failed(error);
    return;
  }

  const rack = new LensRack(engine.exports, () => {
    controls.update();
    screen.draw();
  });
  const screen = new EngineScreen(canvas, engine, rack, { drawn, failed });
  /** @type {Player} */
  const player = new Player(rack, (isPlaying) => controls.focusBar.showPlaying(isPlaying));
  const zoom = new Zoom(view, element("stage", HTMLDivElement));
  const strokes = new RecordedStrokes(page.view);
  const brush = new BrushTool(view, zoom, rack, screen, strokes, { painted, failed });
  /** @type {EngineControls} */
  const controls = new EngineControls(page, rack, player, brush);
  const gestures = new Gestures(view, zoom, rack, { begin, aim: () => {}, click: focusOn }, brush);
  addEventListener("resize", () => zoom.apply());

  function drawn() {
    poster.remove();
    const distance = distanceText(rack.inverseDistance);
    canvas.setAttribute("aria-label", `${page.title}: focused at ${distance}, ${rack.fNumberText}`);
    viewer.dataset.drawn = rack.isMoving ? "draft" : "full";
    viewer.dataset.inverseDistance = String(rack.inverseDistance);
    viewer.dataset.apertureShare = String(rack.apertureShare);
    viewer.dataset.blades = String(rack.blades);
    viewer.dataset.isPainted = String(Number(rack.isPainted));
  }

  function painted() {
    controls.update();
    controls.drawPaint();
  }

  /** Somebody touches the page. */
  function begin() {
    player.stop();
    element("hint", HTMLParagraphElement).classList.add("done");
  }

  /**
   * Focuses on what is at a point of the window.
   *
   * @param {{clientX: number, clientY: number}} point
   */
  function focusOn(point) {
    const inverseDistance = engine.exports.sharp_distance(...zoom.place(point));
    if (Number.isNaN(inverseDistance)) return;
    const canFocus = Number.isFinite(inverseDistance);
    showMark(view, point, canFocus);
    if (canFocus) {
      rack.rest(inverseDistance);
      message.speak(`Focused at ${distanceText(rack.inverseDistance)}`);
    } else {
      message.show("Painted, stays so");
    }
  }

  /** @type {{[key: string]: () => void}} */
  const actions = {
    ArrowLeft: () => rack.step(-0.02),
    ArrowRight: () => rack.step(0.02),
    Home: () => rack.rest(rack.nearest),
    End: () => rack.rest(rack.farthest),
    "+": () => gestures.magnifyMiddle(1.25),
    "=": () => gestures.magnifyMiddle(1.25),
    "-": () => gestures.magnifyMiddle(0.8),
    0: () => gestures.magnifyMiddle(0),
    "[": () => rack.stopDown(rack.stop - 0.1, false),
    "]": () => rack.stopDown(rack.stop + 0.1, false),
    ",": () => controls.scaleBrush(0.8),
    ".": () => controls.scaleBrush(1.25),
    b: () => controls.chooseTool((brush.tool + 1) % TOOLS.length),
    Escape: () => controls.chooseTool(0),
    p: () => controls.toggleKind(),
    t: () => controls.togglePaint(),
    f: toggleFullScreen,
    " ": () => player.toggle(),
    Enter: () => focusOn(zoom.middle),
  };

  addEventListener("keydown", (event) => {
    const { target } = event;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (event.altKey) return;
    if (event.ctrlKey || event.metaKey) {
      if (key === "z" || key === "y") {
        event.preventDefault();
        if (key === "y" || event.shiftKey) brush.redo();
        else brush.undo();
      }
      return;
    }
    // Buttons are pressed by space and enter; radio buttons and sliders have arrows of their own.
    const isButton = target instanceof HTMLButtonElement && (key === " " || key === "Enter");
    const isOwn = target instanceof HTMLInputElement && target.id !== "distance" && /^(Arrow|Home|End| )/.test(key);
    const action = actions[key];
    if (isButton || isOwn || !action) return;
    event.preventDefault();
    // Space stops a rack by itself.
    if (key !== " ") begin();
    action();
  });

  screen.draw();
  if (page.autoplays && !matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();
}
