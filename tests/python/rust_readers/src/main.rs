// SPDX-License-Identifier: GPL-3.0-or-later

//! Prints a line a texture file: what the crates `ktx2` and `image_dds` read of it, or why not.
//!
//! usage: readers FILE...
//!
//! FORMAT WIDTH HEIGHT, then for each level its bytes in hexadecimal digits: as stored in KTX 2
//! files, decoded to RGBA of 8 bits each in DDS files.

use std::error::Error;
use std::fmt::Write;
use std::fs;

fn main() {
    for path in std::env::args().skip(1) {
        match read(&path) {
            Ok(line) => println!("{line}"),
            Err(error) => println!("refused: {}", error.to_string().replace('\n', " ")),
        }
    }
}

fn read(path: &str) -> Result<String, Box<dyn Error>> {
    let data = fs::read(path)?;
    if path.ends_with(".dds") {
        read_dds(&data)
    } else {
        read_ktx2(&data)
    }
}

fn read_ktx2(data: &[u8]) -> Result<String, Box<dyn Error>> {
    let reader = ktx2::Reader::new(data).map_err(|error| format!("{error:?}"))?;
    let header = reader.header();
    let mut line = format!("{:?} {} {}", header.format, header.pixel_width, header.pixel_height);
    for level in reader.levels() {
        line.push_str(&hexadecimal(level.data));
    }
    Ok(line)
}

fn read_dds(data: &[u8]) -> Result<String, Box<dyn Error>> {
    let dds = image_dds::ddsfile::Dds::read(data)?;
    let surface = image_dds::Surface::from_dds(&dds)?;
    let mut line = format!("{:?} {} {}", surface.image_format, surface.width, surface.height);
    for level in 0..surface.mipmaps {
        let decoded = surface.decode_layers_mipmaps_rgba8(0..1, level..level + 1)?;
        line.push_str(&hexadecimal(&decoded.data));
    }
    Ok(line)
}

fn hexadecimal(bytes: &[u8]) -> String {
    let mut text = String::from(" ");
    for byte in bytes {
        let _ = write!(text, "{byte:02x}");
    }
    text
}
