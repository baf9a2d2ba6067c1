//! Which systems a module runs on, as in a wheel's name: `manylinux_2_34_x86_64` is every Linux with glibc 2.34 or newer (PEP 600).

use crate::chore::Failure;

/// The oldest glibc that wheels are tagged for: nothing older has Rust's standard library.
const OLDEST_MINOR: u32 = 17;

/// The least glibc 2.N with which a distribution also has the C++ library of a symbol version `GLIBCXX_3.4.N`, from the policies of
/// `auditwheel`: version, glibc.
const CXX_LIBRARIES: [(u32, u32); 6] = [(19, 17), (24, 28), (28, 31), (29, 34), (30, 35), (32, 39)];

/// The tag of a module, an ELF file, on this machine's architecture.
///
/// # Errors
/// It needs a newer C++ library than any that is known.
pub fn platform_tag(module: &[u8]) -> Result<String, Failure> {
    let glibc = newest(module, b"GLIBC_2.").unwrap_or(OLDEST_MINOR);
    let for_cxx = match newest(module, b"GLIBCXX_3.4.") {
        None => OLDEST_MINOR,
        Some(needed) => {
            CXX_LIBRARIES.iter().find(|(version, _)| needed <= *version).map(|(_, glibc)| *glibc).ok_or_else(
                || {
                    Failure::new(format!(
                        "the module needs GLIBCXX_3.4.{needed}, newer than the table in platform_tag.rs"
                    ))
                },
            )?
        }
    };
    let minor = glibc.max(for_cxx).max(OLDEST_MINOR);
    Ok(format!("manylinux_2_{minor}_{}", std::env::consts::ARCH))
}

/// The largest N of the symbol versions that begin with `prefix`.
fn newest(module: &[u8], prefix: &[u8]) -> Option<u32> {
    let places = module.windows(prefix.len()).enumerate().filter(|(_, window)| *window == prefix);
    let number = |(at, _): (usize, &[u8])| {
        let digits = module[at + prefix.len()..].iter().take(3).take_while(|byte| byte.is_ascii_digit());
        digits.fold(None, |number, digit| Some(number.unwrap_or(0) * 10 + u32::from(digit - b'0')))
    };
    places.filter_map(number).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_symbol_decides() {
        let tag = |module: &[u8]| platform_tag(module).map_err(|failure| failure.to_string());
        let arch = std::env::consts::ARCH;
        assert_eq!(tag(b"\0GLIBC_2.2.5\0GLIBC_2.34\0GLIBC_2.4\0"), Ok(format!("manylinux_2_34_{arch}")));
        assert_eq!(tag(b"GLIBC_2.14\0GLIBCXX_3.4.21\0"), Ok(format!("manylinux_2_28_{arch}")));
        assert_eq!(tag(b"GLIBC_PRIVATE\0"), Ok(format!("manylinux_2_17_{arch}")));
        assert!(tag(b"GLIBCXX_3.4.99").is_err_and(|text| text.contains("3.4.99")));
    }
}
