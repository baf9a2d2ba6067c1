//! Constants that Rust and WGSL share, written in Rust only.

/// A value that a constant of WGSL can have.
pub trait Literal {
    /// Its type and its value in WGSL.
    fn literal(self) -> (&'static str, String);
}

impl Literal for u32 {
    fn literal(self) -> (&'static str, String) {
        ("u32", format!("{self}u"))
    }
}

/// Counts and lengths of arrays.
impl Literal for usize {
    fn literal(self) -> (&'static str, String) {
        ("u32", format!("{self}u"))
    }
}

impl Literal for i32 {
    fn literal(self) -> (&'static str, String) {
        ("i32", format!("{self}i"))
    }
}

/// The shortest decimal that is read as the same float.
impl Literal for f32 {
    fn literal(self) -> (&'static str, String) {
        ("f32", format!("{self:?}f"))
    }
}

/// The declaration of one constant in WGSL.
pub fn declaration(name: &str, value: impl Literal) -> String {
    let (of_type, value) = value.literal();
    format!("const {name}: {of_type} = {value};\n")
}

/// Declarations of constants in WGSL: of those of Rust under their own names, and of values under names that follow a semicolon.
#[macro_export]
macro_rules! constants {
    ($($name:ident),* $(,)? $(; $($as:ident = $value:expr),* $(,)?)?) => {
        [
            $($crate::constants::declaration(stringify!($name), $name),)*
            $($($crate::constants::declaration(stringify!($as), $value),)*)?
        ].concat()
    };
}
