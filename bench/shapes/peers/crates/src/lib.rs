// SPDX-License-Identifier: GPL-3.0-or-later

//! What the benchmark calls of vello_cpu and tiny-skia; see ../crates.cpp and `Drawing` in
//! rasterizers.h.

mod tiny_skia_peer;
mod vello_cpu_peer;

use std::ffi::c_int;

/// See `Drawing` in rasterizers.h.
trait Drawing {
    fn build(&mut self, path: &Path);
    fn clear(&mut self);
    fn draw(&mut self);
    fn coverage(&self, bytes: &mut [u8]);
}

/// See `Path` in patterns.h.
struct Path<'a> {
    verbs: &'a [u8],
    points: &'a [f64],
}

/// What takes a path's parts, in the order that they have.
trait Sink {
    fn move_to(&mut self, p: &[f64]);
    fn line_to(&mut self, p: &[f64]);
    fn quadratic_to(&mut self, p: &[f64]);
    fn cubic_to(&mut self, p: &[f64]);
    fn close(&mut self);
}

impl Path<'_> {
    fn replay(&self, sink: &mut impl Sink) {
        let mut rest = self.points;
        for verb in self.verbs {
            let (p, after) = rest.split_at([2, 2, 4, 6, 0][usize::from(*verb)]);
            rest = after;
            match verb {
                0 => sink.move_to(p),
                1 => sink.line_to(p),
                2 => sink.quadratic_to(p),
                3 => sink.cubic_to(p),
                _ => sink.close(),
            }
        }
    }
}

pub struct Opened {
    size: usize,
    drawing: Box<dyn Drawing>,
}

#[unsafe(no_mangle)]
pub extern "C" fn shapes_crate_open(which: c_int, width: c_int, height: c_int) -> *mut Opened {
    let drawing: Box<dyn Drawing> = match which {
        0 => Box::new(vello_cpu_peer::VelloDrawing::new(
            width as u16,
            height as u16,
        )),
        _ => Box::new(tiny_skia_peer::TinyDrawing::new(
            width as u32,
            height as u32,
        )),
    };
    let size = width as usize * height as usize;
    Box::into_raw(Box::new(Opened { size, drawing }))
}

/// # Safety
/// The drawing is open, and the pointers have as many values as said.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn shapes_crate_build(
    opened: *mut Opened,
    verbs: *const u8,
    verb_count: usize,
    points: *const f64,
    value_count: usize,
) {
    let path = unsafe {
        Path {
            verbs: std::slice::from_raw_parts(verbs, verb_count),
            points: std::slice::from_raw_parts(points, value_count),
        }
    };
    unsafe { &mut *opened }.drawing.build(&path);
}

/// # Safety
/// The drawing is open.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn shapes_crate_clear(opened: *mut Opened) {
    unsafe { &mut *opened }.drawing.clear();
}

/// # Safety
/// The drawing is open.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn shapes_crate_draw(opened: *mut Opened) {
    unsafe { &mut *opened }.drawing.draw();
}

/// # Safety
/// The drawing is open, and there is a byte for each pixel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn shapes_crate_coverage(opened: *const Opened, bytes: *mut u8) {
    let opened = unsafe { &*opened };
    opened
        .drawing
        .coverage(unsafe { std::slice::from_raw_parts_mut(bytes, opened.size) });
}

/// # Safety
/// The drawing is open; it no longer is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn shapes_crate_close(opened: *mut Opened) {
    drop(unsafe { Box::from_raw(opened) });
}
