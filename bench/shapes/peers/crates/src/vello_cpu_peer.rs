// SPDX-License-Identifier: GPL-3.0-or-later

//! vello_cpu, RGBA of 8 bits, the only image that it has.

use crate::{Drawing, Path, Sink};
use vello_cpu::color::palette::css;
use vello_cpu::kurbo::BezPath;
use vello_cpu::{Pixmap, RasterizerSettings, RenderContext, Resources, TargetInit};

pub struct VelloDrawing {
    path: BezPath,
    context: RenderContext,
    resources: Resources,
    pixmap: Pixmap,
}

impl VelloDrawing {
    pub fn new(width: u16, height: u16) -> Self {
        Self {
            path: BezPath::new(),
            context: RenderContext::new(width, height),
            resources: Resources::new(),
            pixmap: Pixmap::new(width, height),
        }
    }
}

impl Sink for BezPath {
    fn move_to(&mut self, p: &[f64]) {
        self.move_to((p[0], p[1]));
    }
    fn line_to(&mut self, p: &[f64]) {
        self.line_to((p[0], p[1]));
    }
    fn quadratic_to(&mut self, p: &[f64]) {
        self.quad_to((p[0], p[1]), (p[2], p[3]));
    }
    fn cubic_to(&mut self, p: &[f64]) {
        self.curve_to((p[0], p[1]), (p[2], p[3]), (p[4], p[5]));
    }
    fn close(&mut self) {
        self.close_path();
    }
}

impl Drawing for VelloDrawing {
    fn build(&mut self, path: &Path) {
        self.path = BezPath::new();
        path.replay(&mut self.path);
    }

    fn clear(&mut self) {
        self.pixmap.data_as_u8_slice_mut().fill(0);
    }

    fn draw(&mut self) {
        self.context.reset();
        self.context.set_paint(css::WHITE);
        self.context.fill_path(&self.path);
        self.context.flush();
        let settings = RasterizerSettings {
            target_init: TargetInit::SrcOver,
            ..Default::default()
        };
        self.context
            .render_with(&mut self.pixmap, &mut self.resources, settings);
    }

    fn coverage(&self, bytes: &mut [u8]) {
        for (byte, pixel) in bytes.iter_mut().zip(self.pixmap.data()) {
            *byte = pixel.a;
        }
    }
}
