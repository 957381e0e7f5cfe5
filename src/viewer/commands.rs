//! The commands of the window, and the keys for them: one table for help and dispatch.

use egui::{Event, Key, KeyboardShortcut, Modifiers};

/// Something done at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ViewCommand {
    /// Shows or hides the keys.
    Help,
    /// Shows the list of files to open.
    Open,
    /// Reads the file again.
    Reload,
    /// Writes edits into the scene file.
    Save,
    /// Takes back the last edit.
    Undo,
    /// Does the edit again that was taken back last.
    Redo,
    /// Writes a picture of this very view.
    Snapshot,
    /// Writes this view into the scene as a camera.
    KeepCamera,
    /// Looks at the whole scene.
    Home,
    /// Goes to the next camera of the scene.
    NextCamera,
    /// Goes to the camera before.
    PreviousCamera,
    /// Shows the next phase of the scene.
    NextPhase,
    /// Shows the phase before.
    PreviousPhase,
    /// Turns about the place that is looked at.
    Orbit,
    /// Flies.
    Fly,
    /// Walks at the height of an eye.
    Walk,
    /// Looks north.
    North,
    /// Looks straight down.
    Down,
    /// Shows or hides the panels.
    Panels,
    /// Shows or hides labels.
    Labels,
    /// Shows or hides the edges of triangles.
    Wireframe,
    /// Keeps the triangles as they are while the camera flies on.
    Freeze,
    /// Puts the cursor into the field that finds features.
    Find,
    /// Digs a crater where the user clicks.
    Crater,
    /// Measures a distance.
    MeasureLine,
    /// Measures an area.
    MeasureArea,
    /// Takes back the last point of what a tool draws or measures.
    TakeBackPoint,
    /// Leaves what is being done: a tool, help, the list of files.
    Cancel,
    /// Shows the window on the whole screen, or not.
    FullScreen,
    /// Closes the window.
    Quit,
}

/// A motion that continues while a key is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum HeldMotion {
    /// Moves toward what is looked at.
    Forward,
    /// Moves away.
    Backward,
    /// Moves to the left.
    Left,
    /// Moves to the right.
    Right,
    /// Moves up.
    Up,
    /// Moves down.
    Down,
    /// Turns to the left.
    TurnLeft,
    /// Turns to the right.
    TurnRight,
    /// Looks up.
    LookUp,
    /// Looks down.
    LookDown,
    /// Comes nearer.
    ZoomIn,
    /// Goes farther off.
    ZoomOut,
}

/// The action of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyAction {
    /// Once, when it is pressed.
    Press(ViewCommand),
    /// As long as it is held, with Shift four times as fast.
    Hold(HeldMotion),
}

/// A row of the table of keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyBinding {
    /// The key, with what is held beside it.
    pub key: KeyboardShortcut,
    /// What it does.
    pub action: KeyAction,
    /// What help says that it does; empty where the row above says it.
    pub says: &'static str,
}

const fn press(modifiers: Modifiers, key: Key, command: ViewCommand, says: &'static str) -> KeyBinding {
    KeyBinding { key: KeyboardShortcut::new(modifiers, key), action: KeyAction::Press(command), says }
}

const fn hold(key: Key, motion: HeldMotion, says: &'static str) -> KeyBinding {
    KeyBinding { key: KeyboardShortcut::new(Modifiers::NONE, key), action: KeyAction::Hold(motion), says }
}

const NONE: Modifiers = Modifiers::NONE;
const CONTROL: Modifiers = Modifiers::COMMAND;
const CONTROL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

/// Every key. What has more modifiers comes first, since it is matched first.
pub const KEYS: &[KeyBinding] = &[
    hold(Key::W, HeldMotion::Forward, "Move forward"),
    hold(Key::S, HeldMotion::Backward, "Move backward"),
    hold(Key::A, HeldMotion::Left, "Move to the left"),
    hold(Key::D, HeldMotion::Right, "Move to the right"),
    hold(Key::E, HeldMotion::Up, "Move up"),
    hold(Key::Q, HeldMotion::Down, "Move down"),
    hold(Key::ArrowLeft, HeldMotion::TurnLeft, "Turn to the left"),
    hold(Key::ArrowRight, HeldMotion::TurnRight, "Turn to the right"),
    hold(Key::ArrowUp, HeldMotion::LookUp, "Look up"),
    hold(Key::ArrowDown, HeldMotion::LookDown, "Look down"),
    hold(Key::Plus, HeldMotion::ZoomIn, "Come nearer"),
    hold(Key::Equals, HeldMotion::ZoomIn, ""),
    hold(Key::Minus, HeldMotion::ZoomOut, "Go farther off"),
    press(NONE, Key::Num1, ViewCommand::Orbit, "Turn about a place"),
    press(NONE, Key::Num2, ViewCommand::Fly, "Fly"),
    press(NONE, Key::Num3, ViewCommand::Walk, "Walk on the ground"),
    press(NONE, Key::C, ViewCommand::NextCamera, "Next camera of the scene"),
    press(Modifiers::SHIFT, Key::C, ViewCommand::PreviousCamera, "Camera before"),
    press(NONE, Key::Period, ViewCommand::NextPhase, "Next phase of the scene"),
    press(NONE, Key::Comma, ViewCommand::PreviousPhase, "Phase before"),
    press(NONE, Key::Home, ViewCommand::Home, "Whole scene"),
    press(NONE, Key::H, ViewCommand::Home, ""),
    press(NONE, Key::N, ViewCommand::North, "Look north"),
    press(NONE, Key::V, ViewCommand::Down, "Look straight down"),
    press(Modifiers::SHIFT, Key::P, ViewCommand::KeepCamera, "Keep this view as a camera of the scene"),
    press(NONE, Key::P, ViewCommand::Snapshot, "Save a picture of this view"),
    press(NONE, Key::K, ViewCommand::Crater, "Dig a crater"),
    press(NONE, Key::M, ViewCommand::MeasureLine, "Measure a line"),
    press(Modifiers::SHIFT, Key::M, ViewCommand::MeasureArea, "Measure an area"),
    press(NONE, Key::L, ViewCommand::Labels, "Labels on or off"),
    press(NONE, Key::X, ViewCommand::Wireframe, "Edges of triangles on or off"),
    press(NONE, Key::F, ViewCommand::Freeze, "Freeze the triangles, and fly on"),
    press(NONE, Key::T, ViewCommand::Panels, "Panels on or off"),
    press(CONTROL, Key::F, ViewCommand::Find, "Find a feature or a position"),
    press(CONTROL, Key::O, ViewCommand::Open, "Open a file"),
    press(CONTROL, Key::R, ViewCommand::Reload, "Read the file again"),
    press(CONTROL, Key::S, ViewCommand::Save, "Save edits into the scene file"),
    press(CONTROL_SHIFT, Key::Z, ViewCommand::Redo, "Redo"),
    press(CONTROL, Key::Y, ViewCommand::Redo, ""),
    press(CONTROL, Key::Z, ViewCommand::Undo, "Undo"),
    press(NONE, Key::Questionmark, ViewCommand::Help, "These keys"),
    press(NONE, Key::F1, ViewCommand::Help, ""),
    press(NONE, Key::F11, ViewCommand::FullScreen, "Whole screen"),
    press(NONE, Key::Backspace, ViewCommand::TakeBackPoint, "Take back the last point of a line"),
    press(NONE, Key::Escape, ViewCommand::Cancel, "Leave a tool or a list"),
    press(CONTROL, Key::Q, ViewCommand::Quit, "Close the window"),
];

/// The commands of the keys pressed since the frame before, in the order of the table. The keys are taken from `input`.
pub fn pressed(input: &mut egui::InputState) -> Vec<ViewCommand> {
    let mut commands = Vec::new();
    for binding in KEYS {
        if let KeyAction::Press(command) = binding.action
            && take(input, &binding.key)
        {
            commands.push(command);
        }
    }
    commands
}

/// Takes presses of `shortcut`, with exactly its modifiers at the time; keys that need Shift on some keyboards may have it.
fn take(input: &mut egui::InputState, shortcut: &KeyboardShortcut) -> bool {
    let needs_shift = shortcut.logical_key == Key::Questionmark;
    let count = input.events.len();
    input.events.retain(|event| {
        let Event::Key { key, pressed: true, modifiers, .. } = event else { return true };
        let is_exact = modifiers.matches_exact(shortcut.modifiers);
        let is_shifted = needs_shift && modifiers.matches_exact(Modifiers::SHIFT);
        *key != shortcut.logical_key || !(is_exact || is_shifted)
    });
    input.events.len() < count
}

/// The motions whose keys are down, or were pressed since the frame before, without Control; in the order of the table.
pub fn held(input: &egui::InputState) -> Vec<HeldMotion> {
    if input.modifiers.command || input.modifiers.alt {
        return Vec::new();
    }
    let was_pressed = |wanted: Key| {
        let is_press = |event: &Event| match event {
            Event::Key { key, pressed: true, modifiers, .. } => *key == wanted && !modifiers.command,
            _ => false,
        };
        input.events.iter().any(is_press)
    };
    let motion = |binding: &KeyBinding| match (binding.action, binding.key.logical_key) {
        (KeyAction::Hold(motion), key) if input.key_down(key) || was_pressed(key) => Some(motion),
        _ => None,
    };
    let mut motions: Vec<HeldMotion> = KEYS.iter().filter_map(motion).collect();
    motions.dedup();
    motions
}

/// The first key of a command, as it is written on a keyboard; empty where it has none.
pub fn key_text(command: ViewCommand) -> String {
    let binding = KEYS.iter().find(|binding| binding.action == KeyAction::Press(command));
    binding.map(|binding| shortcut_text(&binding.key)).unwrap_or_default()
}

/// A shortcut as it is written on a keyboard, such as `Ctrl+S`.
pub fn shortcut_text(shortcut: &KeyboardShortcut) -> String {
    let name = match shortcut.logical_key {
        Key::Questionmark => "?",
        Key::Plus => "+",
        Key::Minus => "-",
        Key::Period => ".",
        Key::Comma => ",",
        Key::ArrowLeft => "Left",
        Key::ArrowRight => "Right",
        Key::ArrowUp => "Up",
        Key::ArrowDown => "Down",
        key => key.name(),
    };
    let held = [(shortcut.modifiers.command, "Ctrl+"), (shortcut.modifiers.shift, "Shift+")];
    let held: String = held.iter().filter(|(is_held, _)| *is_held).map(|(_, text)| *text).collect();
    held + name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_does_two_things_and_every_command_is_explained_once() {
        for (index, binding) in KEYS.iter().enumerate() {
            let twin = KEYS[..index].iter().find(|other| other.key == binding.key);
            assert_eq!(twin, None, "{} is bound twice", shortcut_text(&binding.key));
            let explained =
                KEYS.iter().filter(|other| other.action == binding.action && !other.says.is_empty());
            assert_eq!(explained.count(), 1, "{:?}", binding.action);
        }
    }

    #[test]
    fn keys_read_as_they_are_written_on_a_keyboard() {
        assert_eq!(key_text(ViewCommand::Redo), "Ctrl+Shift+Z");
        assert_eq!(key_text(ViewCommand::Help), "?");
        assert_eq!(key_text(ViewCommand::Freeze), "F");
    }
}
