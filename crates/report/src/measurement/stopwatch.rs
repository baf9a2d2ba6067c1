//! Timing: once if the work is slow, the median of several repeats if it is quick.

use numerics::median;
use session::SessionError;
use std::time::Instant;

/// Slower work is not repeated, s.
const QUICK_SECONDS: f64 = 0.25;
/// Quick work is repeated until this time is spent, s …
const MIN_TOTAL_SECONDS: f64 = 0.5;
/// … or it was done this often.
const MAX_REPEATS: usize = 5;

/// The result of timed work.
pub struct Timed<T> {
    /// The result of the last repeat.
    pub value: T,
    /// Median, s.
    pub seconds: f64,
    /// Number of repeats.
    pub repeats: u32,
}

/// Times `work`, repeating it if it is quick.
///
/// # Errors
/// `work` fails.
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
            return Ok(Timed { value, seconds: median_seconds(&mut times), repeats });
        }
    }
}

/// The median of some times, s; NaN of none. Sorts the times.
pub fn median_seconds(times: &mut [f64]) -> f64 {
    median(times).unwrap_or(f64::NAN)
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
    fn no_times_have_no_median() {
        assert_eq!(median_seconds(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median_seconds(&mut []).is_nan());
    }
}
