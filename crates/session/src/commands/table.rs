//! Every command a user can invoke: one table for menus, palette, keys, documentation and tests.
//!
//! Plain data: the window maps [`Shortcut`] to its own key type and [`CommandId`] to what it does (most send a
//! [`crate::Command`], some open a dialog or change the view).

/// A command that a user can invoke. Key maps and scripts store [`CommandInfo::name`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the table below says what each one does")]
pub enum CommandId {
    Open,
    OpenCapture,
    OpenDemo,
    Save,
    SaveAs,
    ExportPicture,
    ExportShown,
    ExportWebPage,
    ExportEnginePage,
    ExportFocusMap,
    ExportScene,
    ExportStrokes,
    ImportFocusMap,
    ImportPreset,
    Quit,
    Undo,
    Redo,
    SelectLasso,
    SelectBox,
    SelectObject,
    SelectMaterial,
    SelectChart,
    SelectFacing,
    SelectDepth,
    SelectSimilar,
    SelectAll,
    InvertSelection,
    RefineSelection,
    MaskFromSelection,
    HideSelectedSplats,
    ShowAllSplats,
    FrameAll,
    FrameCursor,
    ViewFromCamera,
    PictureFit,
    PictureActualSize,
    ShowFocus,
    ShowSurface,
    ShowAtlas,
    ShowAperture,
    ShowHistogram,
    ShowPhotographs,
    ShowTimeline,
    ShowInspector,
    PaintAsNavigator,
    PaintBeside,
    PaintAbove,
    PictureAlone,
    EnlargePanel,
    FloatPanel,
    ResetLayout,
    FullScreen,
    LightOrDark,
    ScaleUp,
    ScaleDown,
    ScaleReset,
    ShowGuides,
    ShowFocusPlane,
    Walk,
    NextToneCurve,
    KeysBlender,
    KeysSubstance,
    KeysKrita,
    Brush,
    CurveBrush,
    Smooth,
    Sharpen,
    Clone,
    Erase,
    FillPart,
    FillMaterial,
    FillChart,
    FillAll,
    Gradient,
    DepthSpread,
    DepthNearer,
    DepthFarther,
    DepthSmooth,
    PlaceFocalPlane,
    SharpHere,
    FocusHere,
    FixateHere,
    FixateFocus,
    RackFocus,
    Pick,
    Inspect,
    ResetMap,
    BrushSize,
    BrushStrength,
    BrushHardness,
    BrushLarger,
    BrushSmaller,
    BrushHarder,
    BrushSofter,
    BrushStronger,
    BrushWeaker,
    BrushNearer,
    BrushFarther,
    BrushSharp,
    ToggleAnchor,
    ToggleGloss,
    SaveBrushPreset,
    AddLayer,
    AddDepthCurve,
    AddFocalPlane,
    DuplicateLayer,
    RemoveLayer,
    RaiseLayer,
    LowerLayer,
    LayerAbove,
    LayerBelow,
    AddMask,
    InvertMask,
    RemoveMask,
    SpreadStrokes,
    ShowStrokes,
    OpenAperture,
    CloseAperture,
    FocusNearer,
    FocusFarther,
    CameraFromView,
    BookmarkCamera,
    SaveLensPreset,
    SaveBokehPreset,
    OrbitAperture,
    KeyLens,
    KeyLayer,
    RemoveKeys,
    PlayTimeline,
    Normalise,
    Wipe,
    ShowStereo,
    Verify,
    Bake,
    RenderTruth,
    Stop,
    Palette,
    Book,
    Shortcuts,
    ShowMessages,
    About,
}

/// The menu a command stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the menus' own names")]
pub enum Menu {
    File,
    Edit,
    Select,
    View,
    Focus,
    Layer,
    Lens,
    Render,
    Help,
}

impl Menu {
    /// All menus, left to right.
    pub const ALL: [Menu; 9] = [
        Menu::File,
        Menu::Edit,
        Menu::Select,
        Menu::View,
        Menu::Focus,
        Menu::Layer,
        Menu::Lens,
        Menu::Render,
        Menu::Help,
    ];

    /// The title in the menu bar.
    pub fn title(self) -> &'static str {
        match self {
            Menu::File => "File",
            Menu::Edit => "Edit",
            Menu::Select => "Select",
            Menu::View => "View",
            Menu::Focus => "Focus",
            Menu::Layer => "Layer",
            Menu::Lens => "Lens",
            Menu::Render => "Render",
            Menu::Help => "Help",
        }
    }
}

/// A key with its modifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Shortcut {
    /// Ctrl (Cmd on a Mac).
    pub command: bool,
    /// Shift.
    pub shift: bool,
    /// Alt.
    pub alt: bool,
    /// The key as egui names it: `A`, `F2`, `Escape`, `OpenBracket`, `Plus`.
    pub key: &'static str,
}

impl Shortcut {
    pub(crate) const fn key(key: &'static str) -> Option<Self> {
        Some(Self { command: false, shift: false, alt: false, key })
    }
    pub(crate) const fn command(key: &'static str) -> Option<Self> {
        Some(Self { command: true, shift: false, alt: false, key })
    }
    pub(crate) const fn command_shift(key: &'static str) -> Option<Self> {
        Some(Self { command: true, shift: true, alt: false, key })
    }
    pub(crate) const fn command_alt(key: &'static str) -> Option<Self> {
        Some(Self { command: true, shift: false, alt: true, key })
    }
    pub(crate) const fn shift(key: &'static str) -> Option<Self> {
        Some(Self { command: false, shift: true, alt: false, key })
    }
    pub(crate) const fn alt(key: &'static str) -> Option<Self> {
        Some(Self { command: false, shift: false, alt: true, key })
    }
}

impl std::fmt::Display for Shortcut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let modifiers = [(self.command, "Ctrl+"), (self.alt, "Alt+"), (self.shift, "Shift+")];
        for (_, name) in modifiers.into_iter().filter(|(is_pressed, _)| *is_pressed) {
            f.write_str(name)?;
        }
        f.write_str(match self.key {
            "Backtick" => "`",
            "OpenBracket" => "[",
            "CloseBracket" => "]",
            "Comma" => ",",
            "Period" => ".",
            "Escape" => "Esc",
            key => key,
        })
    }
}

/// What the table says about a command.
#[derive(Clone, Copy, Debug)]
pub struct CommandInfo {
    /// Which one.
    pub id: CommandId,
    /// Its name in menu and palette; unique.
    pub name: &'static str,
    /// One sentence that says what it does.
    pub tooltip: &'static str,
    /// Its key in every key map that has no other for it; [`crate::KeyMap::shortcut`] knows.
    pub(crate) shortcut: Option<Shortcut>,
    /// Where it stands.
    pub menu: Menu,
}

const fn command_info(
    id: CommandId,
    menu: Menu,
    shortcut: Option<Shortcut>,
    name: &'static str,
    tooltip: &'static str,
) -> CommandInfo {
    CommandInfo { id, name, tooltip, shortcut, menu }
}

/// The table, in menu order.
#[rustfmt::skip]
pub const COMMANDS: &[CommandInfo] = &[
    command_info(CommandId::Open, Menu::File, Shortcut::command("O"), "Open…", "Open a glTF scene (.glb, .gltf), Gaussian splats (.ply, .spz, .sog, .splat, .ksplat) or a project."),
    command_info(CommandId::OpenCapture, Menu::File, Shortcut::command_shift("O"), "Open a capture…", "Open the folder of a photographed place: pictures, their cameras and a mesh."),
    command_info(CommandId::OpenDemo, Menu::File, None, "Open the demo", "Open the scene that comes with Focus Brush."),
    command_info(CommandId::Save, Menu::File, Shortcut::command("S"), "Save", "Save the project."),
    command_info(CommandId::SaveAs, Menu::File, Shortcut::command_shift("S"), "Save as…", "Save the project under another name."),
    command_info(CommandId::ExportPicture, Menu::File, Shortcut::command("E"), "Export picture…", "Write the picture at full size as EXR or PNG."),
    command_info(CommandId::ExportShown, Menu::File, Shortcut::command_shift("E"), "Export as shown…", "Write the picture at once as it is on screen, at its size there."),
    command_info(CommandId::ExportWebPage, Menu::File, None, "Export web page…", "Write a page on which anyone can refocus the picture in a browser: one file, without a server."),
    command_info(CommandId::ExportEnginePage, Menu::File, None, "Export web page to paint on…", "Write a page on which anyone can choose any lens, and paint, in a browser: one file, without a server."),
    command_info(CommandId::ExportFocusMap, Menu::File, None, "Export focus map…", "Write the painted focus as EXR or 16-bit PNG."),
    command_info(CommandId::ExportScene, Menu::File, None, "Export unwrapped scene…", "Write the scene as GLB with the atlas as its second UV set."),
    command_info(CommandId::ExportStrokes, Menu::File, None, "Export strokes…", "Write the strokes that can be undone as data, to paint them again with `focus-brush replay`."),
    command_info(CommandId::ImportFocusMap, Menu::File, None, "Import focus map…", "Replace the painted focus by a map written earlier."),
    command_info(CommandId::ImportPreset, Menu::File, None, "Import preset…", "Put a brush, lens or bokeh of a file on its list; dropping the file on the window does the same."),
    command_info(CommandId::Quit, Menu::File, Shortcut::command("Q"), "Quit", "Close the window; asks when something is unsaved."),
    command_info(CommandId::Undo, Menu::Edit, Shortcut::command("Z"), "Undo", "Take back the last stroke, fill, selection or lens change."),
    command_info(CommandId::Redo, Menu::Edit, Shortcut::command_shift("Z"), "Redo", "Do again what was taken back."),
    command_info(CommandId::SelectLasso, Menu::Select, Shortcut::key("L"), "Lasso", "Draw around what may be painted; all else is frozen. Shift adds, Ctrl takes away."),
    command_info(CommandId::SelectBox, Menu::Select, Shortcut::shift("L"), "Box", "Drag a box around what may be painted; all else is frozen. Shift adds, Ctrl takes away."),
    command_info(CommandId::SelectObject, Menu::Select, Shortcut::key("O"), "Object", "Click the object that may be painted; all else is frozen. Shift adds, Ctrl takes away."),
    command_info(CommandId::SelectMaterial, Menu::Select, None, "Material", "Click the material that may be painted; all else is frozen. Shift adds, Ctrl takes away."),
    command_info(CommandId::SelectChart, Menu::Select, None, "Chart", "Click the atlas chart that may be painted; all else is frozen. Shift adds, Ctrl takes away."),
    command_info(CommandId::SelectFacing, Menu::Select, None, "Facing alike", "Click what may be painted, with all that faces alike; all else is frozen. Shift adds, Ctrl takes away."),
    command_info(CommandId::SelectDepth, Menu::Select, None, "Depth range", "Drag from the nearest to the farthest thing that may be painted. Shift adds, Ctrl takes away."),
    command_info(CommandId::SelectSimilar, Menu::Select, Shortcut::alt("L"), "Similar and touching", "Click what may be painted: all that touches it and is alike is selected with it, in colour, direction, depth or part; all else is frozen. Shift adds, Ctrl takes away."),
    command_info(CommandId::SelectAll, Menu::Select, Shortcut::command_shift("A"), "Everything", "Let everything be painted again."),
    command_info(CommandId::InvertSelection, Menu::Select, Shortcut::command("I"), "Invert selection", "Freeze what may be painted, and the other way round."),
    command_info(CommandId::RefineSelection, Menu::Select, Shortcut::command_alt("R"), "Refine edges", "Move the outline of what may be painted to the nearest edges of the surface."),
    command_info(CommandId::MaskFromSelection, Menu::Select, None, "Mask from selection", "Let this layer count only where it may be painted."),
    command_info(CommandId::HideSelectedSplats, Menu::Select, None, "Hide splats", "Hide the Gaussian splats that may be painted. Their file is not changed."),
    command_info(CommandId::ShowAllSplats, Menu::Select, None, "Show all splats", "Show all Gaussian splats again: those hidden one by one, those outside the crop box, and those too faint, large or alone."),
    command_info(CommandId::FrameAll, Menu::View, Shortcut::key("Home"), "Frame all", "Show the whole scene in the paint view."),
    command_info(CommandId::FrameCursor, Menu::View, Shortcut::key("F"), "Orbit around cursor", "Centre the paint view on what lies under the cursor."),
    command_info(CommandId::ViewFromCamera, Menu::View, Shortcut::key("0"), "View from camera", "Look through the shot camera in the paint view."),
    command_info(CommandId::Wipe, Menu::View, Shortcut::key("W"), "Compare", "Compare the picture with another one by a line that you drag across it."),
    command_info(CommandId::ShowStereo, Menu::View, Shortcut::alt("S"), "Stereo", "Show the picture for two eyes: for glasses of red and cyan, then side by side, then as it was."),
    command_info(CommandId::Verify, Menu::View, Shortcut::key("R"), "Verify a rectangle", "Drag a rectangle in the picture: rays check the picture there."),
    command_info(CommandId::PictureFit, Menu::View, None, "Fit picture", "Scale the picture to its panel."),
    command_info(CommandId::PictureActualSize, Menu::View, Shortcut::key("1"), "Picture at 100 %", "Show one picture pixel as one screen pixel."),
    command_info(CommandId::ShowGuides, Menu::View, None, "Frame and thirds", "Draw the frame, its thirds and its middle over the picture; or leave them out."),
    command_info(CommandId::ShowFocusPlane, Menu::View, None, "Focus plane", "Draw the line where the lens's focus plane cuts the scene over the picture; or leave it out."),
    command_info(CommandId::Walk, Menu::View, Shortcut::shift("Backtick"), "Walk", "Walk through the scene in the picture: W, A, S, D, down and up by Q, E, drag to look round, wheel for the pace. Enter stays there, Esc goes back."),
    command_info(CommandId::ShowFocus, Menu::View, Shortcut::key("C"), "Show focus", "Colour the paint view by the blur that the focus gives."),
    command_info(CommandId::ShowSurface, Menu::View, Shortcut::key("V"), "Show surface", "Show the scene's own colours in the paint view."),
    command_info(CommandId::ShowAtlas, Menu::View, Shortcut::key("F7"), "Atlas", "Show the focus map flat, chart by chart, to paint on it in 2D; or fold it away."),
    command_info(CommandId::ShowAperture, Menu::View, Shortcut::key("F8"), "Aperture view", "Show what of the aperture a point of the scene sees; or fold it away."),
    command_info(CommandId::ShowHistogram, Menu::View, Shortcut::key("F9"), "Blur histogram", "Show how much of the picture has which circle of confusion; or fold it away."),
    command_info(CommandId::ShowPhotographs, Menu::View, Shortcut::key("F10"), "Photographs", "Show the photographs of a capture, to look through one or on the way between two; or fold them away."),
    command_info(CommandId::ShowTimeline, Menu::View, Shortcut::key("F4"), "Timeline", "Show the keys of lens and layer over time, to scrub and play; or fold them away."),
    command_info(CommandId::ShowInspector, Menu::View, Shortcut::key("F6"), "Inspector", "Show the panels of lens, focus, layers and brush; or fold them away."),
    command_info(CommandId::PaintAsNavigator, Menu::View, Shortcut::command_alt("1"), "Paint view over the picture", "Show the paint view small, over a corner of the picture."),
    command_info(CommandId::PaintBeside, Menu::View, Shortcut::command_alt("2"), "Paint view beside the picture", "Show the views side by side: for tall pictures and wide screens."),
    command_info(CommandId::PaintAbove, Menu::View, Shortcut::command_alt("3"), "Paint view above the picture", "Show the views one above the other: for wide pictures."),
    command_info(CommandId::PictureAlone, Menu::View, Shortcut::key("F3"), "Picture alone", "Show the picture alone, or all panels again."),
    command_info(CommandId::EnlargePanel, Menu::View, Shortcut::command("Space"), "Enlarge panel", "Show the panel that the pointer was over last alone, or all panels again."),
    command_info(CommandId::FloatPanel, Menu::View, None, "Float panel", "Let the panel that the pointer was over last float over the others, or put it back."),
    command_info(CommandId::ResetLayout, Menu::View, None, "Reset layout", "Put the panels back where they were at first."),
    command_info(CommandId::FullScreen, Menu::View, Shortcut::key("F11"), "Full screen", "Let the window fill the screen, or not."),
    command_info(CommandId::NextToneCurve, Menu::View, Shortcut::key("T"), "Next tone mapping", "Show bright light clipped, by Khronos PBR Neutral, or by AgX; files do not change."),
    command_info(CommandId::LightOrDark, Menu::View, None, "Light or dark", "Draw the window light on dark, or dark on light."),
    command_info(CommandId::ScaleUp, Menu::View, Shortcut::command("Plus"), "Larger window contents", "Draw text and controls larger."),
    command_info(CommandId::ScaleDown, Menu::View, Shortcut::command("Minus"), "Smaller window contents", "Draw text and controls smaller."),
    command_info(CommandId::ScaleReset, Menu::View, Shortcut::command("0"), "Window contents at 100 %", "Draw text and controls at the system's size again."),
    command_info(CommandId::KeysBlender, Menu::View, None, "Keys as in Blender", "Keys and mouse as in Blender."),
    command_info(CommandId::KeysSubstance, Menu::View, None, "Keys as in Substance", "Keys and mouse as in Substance 3D Painter."),
    command_info(CommandId::KeysKrita, Menu::View, None, "Keys as in Krita", "Keys and mouse as in Krita."),
    command_info(CommandId::Brush, Menu::Focus, Shortcut::key("B"), "Brush", "Drag in either view to paint the chosen focus. Shift+click draws a straight line, Esc takes a stroke back."),
    command_info(CommandId::CurveBrush, Menu::Focus, Shortcut::shift("B"), "Curve", "Click points in one view: a stroke runs through them. Enter or a double click ends it, Esc gives it up."),
    command_info(CommandId::Smooth, Menu::Focus, Shortcut::key("S"), "Smooth", "Drag in either view to even out the painted focus."),
    command_info(CommandId::Sharpen, Menu::Focus, Shortcut::shift("S"), "Sharpen", "Drag in either view to turn soft changes of the painted focus into hard ones."),
    command_info(CommandId::Clone, Menu::Focus, Shortcut::key("K"), "Clone", "Ctrl+click takes the focus from a place, then drag: the brush paints it elsewhere."),
    command_info(CommandId::Erase, Menu::Focus, Shortcut::key("E"), "Reset brush", "Drag in either view to give the ordinary lens back."),
    command_info(CommandId::FillPart, Menu::Focus, Shortcut::key("G"), "Fill object", "Click an object in either view to give all of it the chosen focus."),
    command_info(CommandId::FillMaterial, Menu::Focus, None, "Fill material", "Click a material in either view to give everything of it the chosen focus."),
    command_info(CommandId::FillChart, Menu::Focus, None, "Fill chart", "Click an atlas chart in either view to give it the chosen focus."),
    command_info(CommandId::FillAll, Menu::Focus, None, "Fill everything", "Give the whole scene the chosen focus."),
    command_info(CommandId::Gradient, Menu::Focus, Shortcut::key("D"), "Gradient", "Drag a line in either view: the chosen focus at its start leads to what is there, or another."),
    command_info(CommandId::DepthSpread, Menu::Focus, Shortcut::key("U"), "Copy depth", "Light fields and pictures with depth: drag from a place whose depth is right over what should be as far."),
    command_info(CommandId::DepthNearer, Menu::Focus, Shortcut::shift("U"), "Pull depth nearer", "Light fields and pictures with depth: drag over what was taken for too far."),
    command_info(CommandId::DepthFarther, Menu::Focus, None, "Push depth farther", "Light fields and pictures with depth: drag over what was taken for too near."),
    command_info(CommandId::DepthSmooth, Menu::Focus, None, "Smooth depth", "Light fields and pictures with depth: drag over rough depth to even it out; edges of the picture stay."),
    command_info(CommandId::PlaceFocalPlane, Menu::Focus, Shortcut::shift("D"), "Place focal plane", "Click three places in either view: the focal plane of the layer runs through the last three. Drag a point to move it."),
    command_info(CommandId::SharpHere, Menu::Focus, Shortcut::shift("H"), "Make sharp", "Click an object in either view to make it sharp; everything else stays as it is."),
    command_info(CommandId::FocusHere, Menu::Focus, Shortcut::key("H"), "Focus here", "Click in either view to focus the lens there."),
    command_info(CommandId::FixateHere, Menu::Focus, Shortcut::alt("H"), "Fixate here", "Click in either view what both eyes look at in stereo pictures: it lies in the screen. The lens stays as it is."),
    command_info(CommandId::FixateFocus, Menu::Focus, None, "Fixate the focus", "Let both eyes look again at what the lens is focused on."),
    command_info(CommandId::RackFocus, Menu::Focus, Shortcut::shift("K"), "Rack focus", "Click in either view what is sharp now, then what becomes sharp: the lens goes from one to the other over time."),
    command_info(CommandId::Pick, Menu::Focus, Shortcut::key("I"), "Pick", "Click in either view to take the brush's focus from there."),
    command_info(CommandId::Inspect, Menu::Focus, Shortcut::key("Q"), "Aperture from here", "Click in either view to see what of the aperture that point sees, and what it sends there."),
    command_info(CommandId::ResetMap, Menu::Focus, None, "Reset all paint", "Return the whole scene to the ordinary lens."),
    command_info(CommandId::BrushSize, Menu::Focus, None, "Set brush size", "Move the mouse, or type the radius and Enter."),
    command_info(CommandId::BrushStrength, Menu::Focus, None, "Set brush strength", "Move the mouse, or type a number up to 1 and Enter."),
    command_info(CommandId::BrushHardness, Menu::Focus, None, "Set brush hardness", "Move the mouse, or type a number up to 1 and Enter."),
    command_info(CommandId::BrushLarger, Menu::Focus, Shortcut::key("CloseBracket"), "Larger brush", "Make the brush larger."),
    command_info(CommandId::BrushSmaller, Menu::Focus, Shortcut::key("OpenBracket"), "Smaller brush", "Make the brush smaller."),
    command_info(CommandId::BrushHarder, Menu::Focus, Shortcut::shift("CloseBracket"), "Harder brush", "Sharpen the brush's edge."),
    command_info(CommandId::BrushSofter, Menu::Focus, Shortcut::shift("OpenBracket"), "Softer brush", "Soften the brush's edge."),
    command_info(CommandId::BrushStronger, Menu::Focus, None, "Stronger brush", "Make strokes stronger."),
    command_info(CommandId::BrushWeaker, Menu::Focus, None, "Weaker brush", "Make strokes weaker."),
    command_info(CommandId::BrushNearer, Menu::Focus, Shortcut::key("Comma"), "Blur nearer", "Move the brush's focus toward near blur."),
    command_info(CommandId::BrushFarther, Menu::Focus, Shortcut::key("Period"), "Blur farther", "Move the brush's focus toward far blur."),
    command_info(CommandId::BrushSharp, Menu::Focus, Shortcut::key("X"), "Paint sharp", "Set the brush to perfectly sharp, wherever the camera focuses."),
    command_info(CommandId::ToggleAnchor, Menu::Focus, Shortcut::key("A"), "Anchor: lens or point", "Paint blur relative to the lens, or to the point itself."),
    command_info(CommandId::ToggleGloss, Menu::Focus, None, "Gloss obeys the paint", "Let what is mirrored or let through obey the brush, too: a car painted sharp has sharp highlights. Else it keeps the lens's own focus."),
    command_info(CommandId::SaveBrushPreset, Menu::Focus, None, "Save brush preset…", "Keep the brush as it is set up, under a name; size and mirrors are not part of it."),
    command_info(CommandId::AddLayer, Menu::Layer, Shortcut::command_shift("N"), "Add layer", "Add an empty layer to paint on, above this one."),
    command_info(CommandId::AddDepthCurve, Menu::Layer, None, "Add depth curve", "Add a layer that gives every depth the blur of a curve you draw."),
    command_info(CommandId::AddFocalPlane, Menu::Layer, None, "Add focal plane", "Add a layer whose plane is sharp, tilted as you like: click three places that it runs through."),
    command_info(CommandId::DuplicateLayer, Menu::Layer, Shortcut::command("J"), "Duplicate layer", "Add a copy of this layer."),
    command_info(CommandId::RemoveLayer, Menu::Layer, Shortcut::shift("Delete"), "Remove layer", "Take this layer away."),
    command_info(CommandId::RaiseLayer, Menu::Layer, Shortcut::command("CloseBracket"), "Raise layer", "Move this layer above the next one."),
    command_info(CommandId::LowerLayer, Menu::Layer, Shortcut::command("OpenBracket"), "Lower layer", "Move this layer beneath the one before."),
    command_info(CommandId::LayerAbove, Menu::Layer, Shortcut::key("PageUp"), "Layer above", "Paint on the next layer above."),
    command_info(CommandId::LayerBelow, Menu::Layer, Shortcut::key("PageDown"), "Layer beneath", "Paint on the next layer beneath."),
    command_info(CommandId::AddMask, Menu::Layer, None, "Add mask", "Give this layer a mask that can be painted; it counts everywhere at first."),
    command_info(CommandId::InvertMask, Menu::Layer, None, "Invert mask", "Make this layer count where it did not, and the other way round."),
    command_info(CommandId::RemoveMask, Menu::Layer, None, "Remove mask", "Make this layer count everywhere."),
    command_info(CommandId::SpreadStrokes, Menu::Layer, Shortcut::command("D"), "Spread strokes", "Spread the strokes of this layer to all that hangs together with them, up to the edges of the surface. Where the ordinary lens is painted nothing is spread."),
    command_info(CommandId::ShowStrokes, Menu::Layer, None, "Show strokes", "Show the strokes of this layer again as they were painted, to paint on."),
    command_info(CommandId::OpenAperture, Menu::Lens, Shortcut::key("Plus"), "Open aperture", "Open the aperture by a third of a stop."),
    command_info(CommandId::CloseAperture, Menu::Lens, Shortcut::key("Minus"), "Close aperture", "Close the aperture by a third of a stop."),
    command_info(CommandId::FocusNearer, Menu::Lens, Shortcut::shift("Comma"), "Focus nearer", "Focus the lens a twentieth nearer."),
    command_info(CommandId::FocusFarther, Menu::Lens, Shortcut::shift("Period"), "Focus farther", "Focus the lens a twentieth farther."),
    command_info(CommandId::CameraFromView, Menu::Lens, Shortcut::command_alt("0"), "Camera from view", "Move the shot camera to where the paint view looks from."),
    command_info(CommandId::BookmarkCamera, Menu::Lens, Shortcut::command_alt("B"), "Bookmark camera", "Keep this camera, with its lens and focus, under a name (section Cameras)."),
    command_info(CommandId::SaveLensPreset, Menu::Lens, None, "Save lens preset…", "Keep focal length, f-number and sensor under a name."),
    command_info(CommandId::SaveBokehPreset, Menu::Lens, None, "Save bokeh preset…", "Keep the aperture's shape under a name, a mask with it."),
    command_info(CommandId::OrbitAperture, Menu::Lens, Shortcut::key("J"), "Look round the aperture", "Show the picture through one point of the aperture that runs round its rim; again or Esc ends it."),
    command_info(CommandId::KeyLens, Menu::Lens, Shortcut::key("Y"), "Key lens", "Keep focus distance, f-number and the lens's character as they are for this time of the timeline."),
    command_info(CommandId::KeyLayer, Menu::Layer, Shortcut::shift("Y"), "Key layer", "Keep the opacity of this layer as it is for this time of the timeline."),
    command_info(CommandId::RemoveKeys, Menu::Lens, Shortcut::alt("Y"), "Remove lens keys", "Take away the keys that the lens has at this time of the timeline."),
    command_info(CommandId::PlayTimeline, Menu::Lens, Shortcut::alt("P"), "Play", "Let lens and layers move as their keys say, again and again; or stop there."),
    command_info(CommandId::Normalise, Menu::Render, Shortcut::key("N"), "Normalise exposure", "Keep a white scene white, or show the conserved energy of the model."),
    command_info(CommandId::Bake, Menu::Render, Shortcut::key("F5"), "Bake again", "Bake the light field anew."),
    command_info(CommandId::RenderTruth, Menu::Render, Shortcut::key("F12"), "Render ground truth", "Ray trace the picture, to compare the preview with."),
    command_info(CommandId::Stop, Menu::Render, Shortcut::command("Period"), "Stop", "Cancel the work that is going on."),
    command_info(CommandId::Palette, Menu::Help, Shortcut::command_shift("P"), "Command palette…", "Find any command by typing part of its name."),
    command_info(CommandId::Book, Menu::Help, None, "The book", "Open the book in the browser: first steps, every subject in depth, files and commands."),
    command_info(CommandId::Shortcuts, Menu::Help, Shortcut::key("F1"), "Keyboard shortcuts", "List every shortcut."),
    command_info(CommandId::ShowMessages, Menu::Help, None, "Messages", "List the messages that were shown."),
    command_info(CommandId::About, Menu::Help, None, "About Focus Brush", "Version, licence and what draws the pictures."),
];

impl CommandId {
    /// Whether running it is an undo step. All other commands do not change the document (they show things, choose tools, set up the
    /// brush), change it only on the next click, or handle whole files.
    pub fn is_undoable(self) -> bool {
        use CommandId::*;
        matches!(
            self,
            SelectAll
                | InvertSelection
                | MaskFromSelection
                | HideSelectedSplats
                | ShowAllSplats
                | FillAll
                | ResetMap
                | AddLayer
                | AddDepthCurve
                | AddFocalPlane
                | DuplicateLayer
                | RemoveLayer
                | RaiseLayer
                | LowerLayer
                | AddMask
                | InvertMask
                | RemoveMask
                | OpenAperture
                | CloseAperture
                | FocusNearer
                | FocusFarther
                | CameraFromView
                | KeyLens
                | KeyLayer
                | RemoveKeys
        )
    }

    /// The command's row in the table.
    pub fn info(self) -> &'static CommandInfo {
        COMMANDS.iter().find(|info| info.id == self).expect("every command has a row")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn names_are_unique_and_tooltips_are_sentences() {
        let mut names = HashSet::new();
        let mut ids = HashSet::new();
        for info in COMMANDS {
            assert!(ids.insert(info.id), "{:?} stands twice", info.id);
            assert!(names.insert(info.name), "{} stands twice", info.name);
            assert!(info.tooltip.ends_with('.'), "{}: the tooltip is a sentence", info.name);
        }
    }
}
