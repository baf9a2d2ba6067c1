//! Catches errors of the graphics device, which would otherwise abort the program.

use std::task::{Context, Poll, Waker};

/// A failure of the graphics device.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GraphicsError {
    /// Its memory is exhausted.
    #[error(
        "paint view: the scene does not fit the graphics memory (close other programs, or open a smaller scene)"
    )]
    OutOfMemory,
    /// It rejected a resource.
    #[error(
        "paint view: the graphics driver refused the scene: {0} (update the driver, or open a smaller scene)"
    )]
    Refused(String),
}

/// Runs `work` and returns the first error of `device` during it.
///
/// # Errors
/// The device reports a validation error or is out of memory.
pub fn catch_device_errors<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T, GraphicsError> {
    let refused = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let done = work();
    if poll_ready(memory.pop()).flatten().is_some() {
        drop(refused);
        return Err(GraphicsError::OutOfMemory);
    }
    match poll_ready(refused.pop()).flatten() {
        Some(error) => Err(GraphicsError::Refused(first_line(&error.to_string()))),
        None => Ok(done),
    }
}

/// The result of a future that is ready immediately on native wgpu.
fn poll_ready<T>(future: impl Future<Output = T>) -> Option<T> {
    match std::pin::pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => Some(value),
        Poll::Pending => None,
    }
}

fn first_line(text: &str) -> String {
    text.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or_default().to_string()
}
