//! Telling what went wrong to someone who has no console.

/// Shows a message and waits until it was read.
#[cfg(windows)]
#[allow(unsafe_code, reason = "the standard library has no message boxes")]
pub fn show(text: &str) {
    use windows_sys::Win32::UI::WindowsAndMessaging::{MB_ICONERROR, MB_OK, MessageBoxW};
    let wide = |text: &str| text.encode_utf16().filter(|&unit| unit != 0).chain([0]).collect::<Vec<u16>>();
    let (text, title) = (wide(text), wide("Focus Brush"));
    // SAFETY: both texts end with the only NUL in them, and live until the function returns.
    unsafe {
        MessageBoxW(std::ptr::null_mut(), text.as_ptr(), title.as_ptr(), MB_OK | MB_ICONERROR);
    }
}

/// Prints the message.
#[cfg(not(windows))]
pub fn show(text: &str) {
    eprintln!("{text}");
}
