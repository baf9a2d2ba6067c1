//! The keyword arguments of `render` as its options: names, ranges and defaults of the command line.

use crate::errors::exception;
use document::Input;
use graphics_card::{BackendChoice, Gpu};
use light::LightQuality;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use render::{Aov, MAX_CELLS_A_SIDE, RenderError, RenderOptions, Renderer, ScatterOptions};
use std::ops::RangeInclusive;

/// The options for keyword arguments of a picture of `input`.
///
/// # Errors
/// An argument is unknown, of another type, out of range, or does not apply to this input; or the graphics card is absent.
pub fn render_options(fields: Option<&Bound<'_, PyDict>>, input: &Input) -> PyResult<RenderOptions> {
    let mut options = match fields.map(|fields| fields.get_item("tolerance")).transpose()?.flatten() {
        Some(tolerance) if !tolerance.is_none() => RenderOptions::at_tolerance(non_negative(&tolerance)?),
        _ => RenderOptions::default(),
    };
    let mut backend = BackendChoice::Cpu;
    for (name, value) in fields.into_iter().flatten() {
        let name: String = name.extract()?;
        if value.is_none() || name == "tolerance" {
            continue;
        }
        match name.as_str() {
            "renderer" => {
                options.renderer = choice(&name, &value, &Renderer::ALL)?;
            }
            "spp" => options.truth.samples_per_pixel = whole(&name, &value, 1..=1 << 20)?,
            "seed" => {
                let seed = whole(&name, &value, 0..=u32::MAX)?;
                options.truth.seed = seed;
                options.scatter = ScatterOptions { seed, ..options.scatter };
            }
            "cells" => options.cells_a_side = whole(&name, &value, 1..=MAX_CELLS_A_SIDE)?,
            "light_passes" => options.light = LightQuality::from_passes(whole(&name, &value, 0..=1 << 16)?),
            "aov" => options.aovs = aovs(&value)?,
            "backend" => backend = choice(&name, &value, &BACKENDS)?,
            _ => {
                let available = "renderer, spp, seed, tolerance, cells, light_passes, aov, backend";
                return Err(PyTypeError::new_err(format!(
                    "render: there is no {name:?} (there are {available})"
                )));
            }
        }
    }
    check(&mut options, input)?;
    options.gpu = open_gpu(backend, options.renderer)?;
    Ok(options)
}

/// The backends by name.
const BACKENDS: [(&str, BackendChoice); 3] =
    [("cpu", BackendChoice::Cpu), ("gpu", BackendChoice::Gpu), ("auto", BackendChoice::Auto)];

fn open_gpu(backend: BackendChoice, renderer: Renderer) -> PyResult<Option<Gpu>> {
    if renderer != Renderer::Splat {
        let message =
            || format!("backend: renderer {} has no GPU backend (use cpu or auto)", renderer.name());
        return match backend {
            BackendChoice::Gpu => Err(exception(RenderError::GpuAbsent(message()))),
            BackendChoice::Cpu | BackendChoice::Auto => Ok(None),
        };
    }
    Gpu::open(backend, None).map_err(|absent| exception(RenderError::GpuAbsent(absent.to_string())))
}

/// Checks that the options apply to the input and to each other.
fn check(options: &mut RenderOptions, input: &Input) -> PyResult<()> {
    let refuse = |name: &str, what: &str| Err(PyValueError::new_err(format!("{name}: {what}")));
    if input.salf.is_some() && options.renderer.draws_light_field() {
        if options.cells_a_side > 1 && options.tolerance_px > 0.0 {
            return refuse(
                "cells",
                "already baked, with one cell per pixel (leave it out, or render the scene)",
            );
        }
        if options.light != LightQuality::Fine {
            return refuse(
                "light_passes",
                "already baked, including its light (leave it out, or render the scene)",
            );
        }
        options.cells_a_side = 1;
    }
    if options.renderer == Renderer::Truth && options.light != LightQuality::Fine {
        return refuse(
            "light_passes",
            "the ground truth has no cached light to refine (leave it out, or use spp)",
        );
    }
    if options.aovs.contains(&Aov::StandardError) && options.renderer != Renderer::Truth {
        return refuse("aov", "only the ground truth has a standard error (use renderer=\"truth\")");
    }
    if options.aovs.iter().any(|aov| aov.needs_paths()) && !options.renderer.resolves_paths() {
        return refuse("aov", "alpha, crypto and pinhole need renderer splat or truth");
    }
    Ok(())
}

fn aovs(value: &Bound<'_, PyAny>) -> PyResult<Vec<Aov>> {
    let names: Vec<String> = value.extract()?;
    let named = |name: &String| {
        Aov::named(name).ok_or_else(|| {
            let available: Vec<_> = Aov::ALL.iter().map(|(name, _)| *name).collect();
            PyValueError::new_err(format!("aov: there is no {name:?} (choose of {})", available.join(", ")))
        })
    };
    names.iter().map(named).collect()
}

fn choice<T: Copy>(name: &str, value: &Bound<'_, PyAny>, all: &[(&str, T)]) -> PyResult<T> {
    let chosen: String = value.extract()?;
    all.iter().find(|(entry, _)| *entry == chosen).map(|(_, choice)| *choice).ok_or_else(|| {
        let available: Vec<_> = all.iter().map(|(entry, _)| *entry).collect();
        PyValueError::new_err(format!("{name}: there is no {chosen:?} (choose of {})", available.join(", ")))
    })
}

fn whole(name: &str, value: &Bound<'_, PyAny>, range: RangeInclusive<u32>) -> PyResult<u32> {
    let number: i128 = value.extract()?;
    u32::try_from(number).ok().filter(|number| range.contains(number)).ok_or_else(|| {
        let (least, most) = (range.start(), range.end());
        PyValueError::new_err(format!("{name}: {number} is out of range (give {least} to {most})"))
    })
}

fn non_negative(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let number: f64 = value.extract()?;
    Some(number).filter(|x| *x >= 0.0 && x.is_finite()).ok_or_else(|| {
        PyValueError::new_err(format!("tolerance: {number} cannot be used (give a number of 0 or more)"))
    })
}
