// SPDX-License-Identifier: GPL-3.0-or-later

//! tiny-skia, an 8-bit mask.

use crate::{Drawing, Path, Sink};
use tiny_skia::{FillRule, Mask, PathBuilder, Transform};

pub struct TinyDrawing {
    path: Option<tiny_skia::Path>,
    mask: Mask,
}

impl TinyDrawing {
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            path: None,
            mask: Mask::new(width, height).unwrap(),
        }
    }
}

struct Builder(PathBuilder);

impl Sink for Builder {
    fn move_to(&mut self, p: &[f64]) {
        self.0.move_to(p[0] as f32, p[1] as f32);
    }
    fn line_to(&mut self, p: &[f64]) {
        self.0.line_to(p[0] as f32, p[1] as f32);
    }
    fn quadratic_to(&mut self, p: &[f64]) {
        self.0
            .quad_to(p[0] as f32, p[1] as f32, p[2] as f32, p[3] as f32);
    }
    fn cubic_to(&mut self, p: &[f64]) {
        let [x1, y1, x2, y2, x3, y3] = std::array::from_fn(|i| p[i] as f32);
        self.0.cubic_to(x1, y1, x2, y2, x3, y3);
    }
    fn close(&mut self) {
        self.0.close();
    }
}

impl Drawing for TinyDrawing {
    fn build(&mut self, path: &Path) {
        let mut builder = Builder(PathBuilder::new());
        path.replay(&mut builder);
        self.path = builder.0.finish();
    }

    fn clear(&mut self) {
        self.mask.clear();
    }

    fn draw(&mut self) {
        let path = self.path.as_ref().unwrap();
        self.mask
            .fill_path(path, FillRule::Winding, true, Transform::identity());
    }

    fn coverage(&self, bytes: &mut [u8]) {
        bytes.copy_from_slice(self.mask.data());
    }
}
