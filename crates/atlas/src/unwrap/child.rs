//! Unwrapping engines in child processes: a child that crashes or hangs is killed, and the program goes on.
//!
//! The child is the running program itself, started with a hidden first argument, or a script that calls [`run`]. Its
//! standard input and output are
//! unnamed temporary files: no pipe can fill up and block either side, and whatever a child finished before it died
//! can still be read.
//!
//! The parent polls its children and sleeps in between, because the standard library has no way to wait for a process
//! *with a deadline and cancellation*. This is the one place below `render` that waits by the clock.

use crate::unwrap::engine::Engine;
use crate::unwrap::surface_patch::{FlattenedPatch, SurfacePatch};
use progress::{Cancelled, Progress};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The hidden first argument that makes a program a child.
const CHILD_ARGUMENT: &str = "--unwrap-child";

/// The first bytes of a child's output. A program that does not write them is no child.
const GREETING: &[u8; 8] = b"unwrap 1";

/// The exit code of a child that ran out of memory.
const OUT_OF_MEMORY: i32 = 75;

/// Interval at which the parent polls its children.
const POLL_INTERVAL: Duration = Duration::from_millis(4);

/// How much longer than its deadline an orphaned child lives.
const ORPHAN_GRACE: Duration = Duration::from_secs(5);

/// How Windows starts a program of the console without one (`CREATE_NO_WINDOW`, winbase.h).
#[cfg(windows)]
const CREATE_NO_WINDOW: u32 = 0x0800_0000;

/// Maximum number of triangles or vertices of a patch; a request for more is broken.
const MAX_PATCH_TRIANGLES: u32 = 1 << 26;

/// Call this first in `main`: in a child process it does the work and exits; otherwise it returns at once.
pub fn run_if_child() {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    if arguments.first().is_some_and(|word| word == CHILD_ARGUMENT) {
        run(&arguments);
    }
}

/// Does the work of a child process with the arguments it was started with, without the program and
/// [`UnwrapOptions::child_arguments`](crate::UnwrapOptions::child_arguments), and ends the process: with code 2 if they are not those of
/// a child.
pub fn run(arguments: &[OsString]) -> ! {
    let word = |n: usize| arguments.get(n).and_then(|a| a.to_str());
    let engine = word(1).and_then(Engine::from_name);
    let deadline = word(2).and_then(|ms| ms.parse().ok()).map(Duration::from_millis);
    let (Some(CHILD_ARGUMENT), Some(engine), Some(deadline)) = (word(0), engine, deadline) else {
        std::process::exit(2)
    };
    // If the parent dies, nobody else kills a child that hangs.
    std::thread::spawn(move || {
        std::thread::sleep(deadline.saturating_add(ORPHAN_GRACE));
        std::process::exit(124);
    });
    let done = serve(engine, &mut BufReader::new(io::stdin().lock()), &mut io::stdout().lock());
    std::process::exit(i32::from(done.is_err()));
}

/// Flattens one patch after another; each result is written before the next patch can crash the process.
fn serve(engine: Engine, input: &mut impl Read, output: &mut impl Write) -> io::Result<()> {
    output.write_all(GREETING)?;
    output.flush()?;
    let count = read_u32(input)?;
    for _ in 0..count {
        let patch = SurfacePatch::read(input)?;
        let flattened = engine.flatten(&patch);
        let mut answer = Vec::new();
        write_answer(flattened.as_ref(), &mut answer)?;
        output.write_all(&answer)?;
        output.flush()?;
    }
    Ok(())
}

/// How children are started.
pub(crate) struct ChildProgram<'a> {
    /// The program.
    pub path: &'a Path,
    /// What it is started with before the hidden argument.
    pub arguments: &'a [OsString],
    /// Time limit for the work of one of them.
    pub deadline: Duration,
}

/// The results of a batch of patches.
pub(crate) struct ChildResults {
    /// The flattening of each patch, if any.
    pub flattened: Vec<Option<FlattenedPatch>>,
    /// How many children crashed or were killed at their deadline.
    pub lost: usize,
}

/// Why no child can be used.
#[derive(Debug)]
pub(crate) enum ChildError {
    /// The work was cancelled; all children have been killed.
    Cancelled,
    /// The machine has too little memory for it: another engine would have too little, too.
    OutOfMemory,
    /// The program does not start, or is not an unwrapping child.
    Unusable(String),
}

/// A child at work on the patches `first..first + count`.
struct RunningChild {
    process: Child,
    output: File,
    first: usize,
    count: usize,
    started: Instant,
}

impl Drop for RunningChild {
    fn drop(&mut self) {
        // Both fail only for a process that has already exited.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Flattens patches with several children in parallel, each working on at most about `batch` triangles.
pub(crate) fn flatten_in_children(
    program: &ChildProgram,
    engine: Engine,
    patches: &[&SurfacePatch],
    batch: usize,
    progress: &dyn Progress,
) -> Result<ChildResults, ChildError> {
    let slots = std::thread::available_parallelism().map_or(1, usize::from);
    let mut answers = ChildResults { flattened: vec![None; patches.len()], lost: 0 };
    let mut waiting = split_batches(patches, batch).into_iter();
    let mut running: Vec<RunningChild> = Vec::new();
    let mut done = 0;
    loop {
        while running.len() < slots
            && let Some((first, count)) = waiting.next()
        {
            running.push(start(program, engine, patches, first, count).map_err(unusable(program))?);
        }
        if running.is_empty() {
            return Ok(answers);
        }
        std::thread::sleep(POLL_INTERVAL);
        progress.check()?;
        let mut still = Vec::new();
        for mut child in running {
            let ended = child.process.try_wait().map_err(unusable(program))?;
            if ended.is_none() && child.started.elapsed() < program.deadline {
                still.push(child);
                continue;
            }
            if ended.is_some_and(|status| status.code() == Some(OUT_OF_MEMORY)) {
                return Err(ChildError::OutOfMemory);
            }
            let lost = ended.is_none_or(|status| !status.success());
            answers.lost += usize::from(lost);
            done += child.count;
            collect(&mut child, &mut answers.flattened).map_err(unusable(program))?;
            progress.report(done as f32 / patches.len() as f32);
        }
        running = still;
    }
}

fn unusable<'a>(program: &'a ChildProgram<'a>) -> impl Fn(io::Error) -> ChildError + use<'a> {
    move |error| match error.kind() {
        // The last is what the system says if it has no memory for another process.
        io::ErrorKind::OutOfMemory | io::ErrorKind::WouldBlock => ChildError::OutOfMemory,
        _ => ChildError::Unusable(format!("{}: {error}", program.path.display())),
    }
}

impl From<Cancelled> for ChildError {
    fn from(_: Cancelled) -> Self {
        ChildError::Cancelled
    }
}

/// Splits the patches into runs of about `triangles` triangles: first and count of each.
fn split_batches(patches: &[&SurfacePatch], triangles: usize) -> Vec<(usize, usize)> {
    let mut result: Vec<(usize, usize)> = Vec::new();
    let mut size = usize::MAX;
    for (i, patch) in patches.iter().enumerate() {
        match result.last_mut() {
            Some(last) if size + patch.corners.len() <= triangles => last.1 += 1,
            _ => {
                result.push((i, 1));
                size = 0;
            }
        }
        size += patch.corners.len();
    }
    result
}

fn start(
    program: &ChildProgram,
    engine: Engine,
    patches: &[&SurfacePatch],
    first: usize,
    count: usize,
) -> io::Result<RunningChild> {
    let mut input = BufWriter::new(tempfile::tempfile()?);
    input.write_all(&(count as u32).to_le_bytes())?;
    patches[first..first + count].iter().try_for_each(|patch| patch.write(&mut input))?;
    let mut input = input.into_inner()?;
    input.rewind()?;
    let output = tempfile::tempfile()?;
    let mut command = Command::new(program.path);
    // Programs without a console would open one for each child.
    #[cfg(windows)]
    std::os::windows::process::CommandExt::creation_flags(&mut command, CREATE_NO_WINDOW);
    let process = command
        .args(program.arguments)
        .args([CHILD_ARGUMENT, engine.name(), &program.deadline.as_millis().to_string()])
        .stdin(Stdio::from(input))
        .stdout(Stdio::from(output.try_clone()?))
        .stderr(Stdio::null())
        .spawn()?;
    Ok(RunningChild { process, output, first, count, started: Instant::now() })
}

/// Ends a child and reads its results. An error if it is not an unwrapping child.
fn collect(child: &mut RunningChild, flattened: &mut [Option<FlattenedPatch>]) -> io::Result<()> {
    // An error means that it has already exited.
    let _ = child.process.kill();
    child.process.wait()?;
    child.output.rewind()?;
    let mut output = BufReader::new(&child.output);
    let mut hello = [0; GREETING.len()];
    if output.read_exact(&mut hello).is_err() || hello != *GREETING {
        return Err(io::Error::other("does not answer as an unwrapping child"));
    }
    for place in &mut flattened[child.first..child.first + child.count] {
        // An incomplete result belongs to the patch at which the child died.
        let Ok(answer) = read_answer(&mut output) else { break };
        *place = answer;
    }
    Ok(())
}

impl SurfacePatch {
    fn write(&self, output: &mut impl Write) -> io::Result<()> {
        output.write_all(&(self.positions.len() as u32).to_le_bytes())?;
        output.write_all(&(self.corners.len() as u32).to_le_bytes())?;
        self.positions.as_flattened().iter().try_for_each(|x| output.write_all(&x.to_le_bytes()))?;
        self.corners.as_flattened().iter().try_for_each(|x| output.write_all(&x.to_le_bytes()))
    }

    fn read(input: &mut impl Read) -> io::Result<Self> {
        let (vertices, triangles) = (read_count(input)?, read_count(input)?);
        let mut positions = Vec::with_capacity(vertices);
        for _ in 0..vertices {
            positions.push([read_f32(input)?, read_f32(input)?, read_f32(input)?]);
        }
        let mut corners = Vec::with_capacity(triangles);
        for _ in 0..triangles {
            corners.push([read_u32(input)?, read_u32(input)?, read_u32(input)?]);
        }
        Ok(Self { positions, corners })
    }
}

/// Number of triangles (0: the engine refused the patch), charts, corners.
fn write_answer(flattened: Option<&FlattenedPatch>, output: &mut impl Write) -> io::Result<()> {
    let Some(flattened) = flattened else { return output.write_all(&0u32.to_le_bytes()) };
    output.write_all(&(flattened.chart.len() as u32).to_le_bytes())?;
    flattened.chart.iter().try_for_each(|x| output.write_all(&x.to_le_bytes()))?;
    let corners = flattened.corners.as_flattened().as_flattened();
    corners.iter().try_for_each(|x| output.write_all(&x.to_le_bytes()))
}

fn read_answer(input: &mut impl Read) -> io::Result<Option<FlattenedPatch>> {
    let triangles = read_count(input)?;
    if triangles == 0 {
        return Ok(None);
    }
    let mut flattened = FlattenedPatch::unplaced(triangles);
    for chart in &mut flattened.chart {
        *chart = read_u32(input)?;
    }
    for x in flattened.corners.as_flattened_mut().as_flattened_mut() {
        *x = read_f32(input)?;
    }
    Ok(Some(flattened))
}

fn read_count(input: &mut impl Read) -> io::Result<usize> {
    let count = read_u32(input)?;
    if count > MAX_PATCH_TRIANGLES {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a patch too large"));
    }
    Ok(count as usize)
}

fn read_u32(input: &mut impl Read) -> io::Result<u32> {
    let mut bytes = [0; 4];
    input.read_exact(&mut bytes)?;
    Ok(u32::from_le_bytes(bytes))
}

fn read_f32(input: &mut impl Read) -> io::Result<f32> {
    read_u32(input).map(f32::from_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_and_its_answer_survive_the_wire() {
        let patch = SurfacePatch {
            positions: vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.5]],
            corners: vec![[0, 1, 2], [2, 1, 3]],
        };
        let mut request = 1u32.to_le_bytes().to_vec();
        patch.write(&mut request).unwrap();
        let mut output = Vec::new();
        serve(Engine::Uvunwrap, &mut request.as_slice(), &mut output).unwrap();
        let answer = read_answer(&mut &output[GREETING.len()..]).unwrap();
        assert_eq!(answer, Engine::Uvunwrap.flatten(&patch));
        assert!(answer.is_some());
        assert!(
            read_answer(&mut &output[GREETING.len()..output.len() - 1]).is_err(),
            "a torn answer is no answer"
        );
    }

    #[test]
    fn batches_hold_at_least_one_patch() {
        let patch = |n| SurfacePatch { positions: Vec::new(), corners: vec![[0; 3]; n] };
        let patches = [patch(50), patch(3), patch(4), patch(90), patch(1)];
        assert_eq!(split_batches(&patches.iter().collect::<Vec<_>>(), 10), [(0, 1), (1, 2), (3, 1), (4, 1)]);
    }
}
