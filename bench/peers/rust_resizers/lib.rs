// SPDX-License-Identifier: GPL-3.0-or-later

//! fast_image_resize and pic-scale for bench/peers/resizers.py: Lanczos 3 of bytes, by one thread.
//! Build it outside of the checkout: cargo build --release --target-dir FOLDER
//! Images are rows of interleaved channels without gaps, 3 or 4 of them, the fourth straight alpha.

use fast_image_resize as fir;
use pic_scale::{
    ImageSize, ImageStore, ImageStoreMut, LinearScaler, ResamplingFunction, Scaler, ThreadingPolicy,
};
use std::slice;

unsafe fn views<'a>(
    from: *const u8, to: *mut u8, sizes: [usize; 4], channels: usize,
) -> (&'a [u8], &'a mut [u8]) {
    let [width, height, new_width, new_height] = sizes;
    (
        slice::from_raw_parts(from, width * height * channels),
        slice::from_raw_parts_mut(to, new_width * new_height * channels),
    )
}

/// In linear light its bytes become words, by its own tables; alpha is multiplied and divided.
/// # Safety
/// The images must have these sizes.
#[no_mangle]
pub unsafe extern "C" fn fir_resize(
    from: *const u8, width: usize, height: usize, to: *mut u8, new_width: usize,
    new_height: usize, channels: usize, srgb: bool,
) {
    let (from, to) = views(from, to, [width, height, new_width, new_height], channels);
    let (bytes, words) = if channels == 3 {
        (fir::PixelType::U8x3, fir::PixelType::U16x3)
    } else {
        (fir::PixelType::U8x4, fir::PixelType::U16x4)
    };
    let (w, h, nw, nh) = (width as u32, height as u32, new_width as u32, new_height as u32);
    let source = fir::images::ImageRef::new(w, h, from, bytes).unwrap();
    let mut target = fir::images::Image::from_slice_u8(nw, nh, to, bytes).unwrap();
    let lanczos = fir::ResizeAlg::Convolution(fir::FilterType::Lanczos3);
    let options = fir::ResizeOptions::new().resize_alg(lanczos);
    let mut resizer = fir::Resizer::new();
    if !srgb {
        resizer.resize(&source, &mut target, &options).unwrap();
        return;
    }
    let mapper = fir::create_srgb_mapper();
    let mut light = fir::images::Image::new(w, h, words);
    let mut small = fir::images::Image::new(nw, nh, words);
    mapper.forward_map(&source, &mut light).unwrap();
    resizer.resize(&light, &mut small, &options).unwrap();
    mapper.backward_map(&small, &mut target).unwrap();
}

/// The scaler of linear light has floats in between.
/// # Safety
/// The images must have these sizes.
#[no_mangle]
pub unsafe extern "C" fn pic_scale_resize(
    from: *const u8, width: usize, height: usize, to: *mut u8, new_width: usize,
    new_height: usize, channels: usize, srgb: bool,
) {
    let (from, to) = views(from, to, [width, height, new_width, new_height], channels);
    let sizes = (ImageSize::new(width, height), ImageSize::new(new_width, new_height));
    let filter = ResamplingFunction::Lanczos3;
    macro_rules! run {
        ($channels:literal, $plan:ident $(, $multiply:expr)?) => {{
            let source = ImageStore::<u8, $channels>::from_slice(from, width, height).unwrap();
            let mut target =
                ImageStoreMut::<u8, $channels>::from_slice(to, new_width, new_height).unwrap();
            if srgb {
                let mut scaler = LinearScaler::new(filter);
                scaler.set_threading_policy(ThreadingPolicy::Single);
                let plan = scaler.$plan(sizes.0, sizes.1 $(, $multiply)?).unwrap();
                plan.resample(&source, &mut target).unwrap();
            } else {
                let mut scaler = Scaler::new(filter);
                scaler.set_threading_policy(ThreadingPolicy::Single);
                let plan = scaler.$plan(sizes.0, sizes.1 $(, $multiply)?).unwrap();
                plan.resample(&source, &mut target).unwrap();
            }
        }};
    }
    if channels == 3 {
        run!(3, plan_rgb_resampling)
    } else {
        run!(4, plan_rgba_resampling, true)
    }
}
