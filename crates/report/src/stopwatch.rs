//! How long something takes: once if it is slow, the median of a few times if it is quick.

use session::SessionError;
use std::time::Instant;

/// Work that takes longer is not repeated, s.
const QUICK_SECONDS: f64 = 0.25;
/// Quick work is repeated until this is spent, s …
const MIN_TOTAL_SECONDS: f64 = 0.5;
/// … or it was done this often.
const MAX_REPEATS: usize = 5;

/// What was made, and how long it took.
pub struct Timed<T> {
    /// What the last repeat made.
    pub value: T,
    /// Median, s.
    pub seconds: f64,
    /// How often it was done.
    pub repeats: u32,
}

/// Does `work`, and again if it is quick.
pub fn measure_time<T>(mut work: impl FnMut() -> Result<T, SessionError>) -> Result<Timed<T>, SessionError> {
    let mut times = Vec::new();
    loop {
        let start = Instant::now();
        let value = work()?;
        times.push(start.elapsed().as_secs_f64());
        let spent: f64 = times.iter().sum();
        let is_quick = times[0] <= QUICK_SECONDS;
        if !is_quick || spent >= MIN_TOTAL_SECONDS || times.len() >= MAX_REPEATS {
            let repeats = times.len() as u32;
            return Ok(Timed { value, seconds: median(&mut times), repeats });
        }
    }
}

/// The middle value, or the mean of the two in the middle. Sorts; NaN for none.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[middle],
        _ => (values[middle - 1] + values[middle]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quick_work_is_repeated_and_slow_work_is_not() {
        let mut count = 0;
        let quick = measure_time(|| {
            count += 1;
            Ok(count)
        });
        let quick = quick.unwrap();
        assert_eq!((quick.repeats as usize, quick.value), (MAX_REPEATS, MAX_REPEATS));
        let slow = measure_time(|| {
            std::thread::sleep(std::time::Duration::from_millis(260));
            Ok(())
        });
        let slow = slow.unwrap();
        assert!(slow.repeats == 1 && slow.seconds >= 0.26, "{} {}", slow.repeats, slow.seconds);
        assert!(measure_time(|| Err::<(), _>(SessionError::Cancelled)).is_err());
    }

    #[test]
    fn medians() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&mut []).is_nan());
    }
}
