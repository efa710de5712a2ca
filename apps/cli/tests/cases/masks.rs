//! Masks are carried byte for byte or named, and never fused.

use aquafuse::image::Image;
use aquafuse_data::image_file::{ImageFile, WriteOptions};

use super::run::Run;
use super::{augmented, refused, with_images};

/// Writes a mask: two colours in two blocks.
fn mask(run: &Run, name: &str) {
    let path = run.path("set").join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let colour = |at: usize| if at % 96 < 40 { [200_u8, 60, 60] } else { [0; 3] };
    let pixels = (0..96 * 64).flat_map(colour).collect();
    let image = ImageFile::new(Image::from_raw(96, 64, pixels).unwrap());
    // Written as PNG, whatever it is called: SUIM's are BMP, which is not written here.
    let png = path.with_extension("png");
    image.write(&png, &WriteOptions::default()).unwrap();
    std::fs::rename(png, path).unwrap();
}

/// Masks that are the same for the image's variant.
fn carried(image: &str, masks: &[&str]) {
    let run = with_images(&[image]);
    masks.iter().for_each(|name| mask(&run, name));
    let said = augmented(&run).stdout;
    assert!(said.contains("1 variants of 1 images"), "{said}");
    for name in masks {
        let (before, end) = name.rsplit_once('.').unwrap();
        let bytes = run.bytes(&format!("set/{name}"));
        assert_eq!(run.bytes(&format!("out/{before}__green__0.{end}")), bytes, "{name}");
        assert_eq!(run.bytes(&format!("out/{name}")), bytes, "{name}");
    }
}

#[test]
fn masks_deepfish() {
    carried("Segmentation/images/valid/a.png", &["Segmentation/masks/valid/a.png"]);
}

#[test]
fn masks_in_labels() {
    carried("images/a.jpg", &["labels/a.png"]);
}

#[test]
fn suim_class_masks() {
    carried("TEST/images/a.jpg", &["TEST/masks/a.bmp", "TEST/masks/FV/a.bmp", "TEST/masks/RO/a.bmp"]);
}

#[test]
fn masks_beside_pictures() {
    let run = with_images(&["a.jpg", "b.jpg"]);
    mask(&run, "a.png");
    mask(&run, "b.png");
    refused(&run, &["2 .png like masks (a.png, b.png)", "Put masks into a folder masks/", "--format folder"]);
}

/// Masks whose folders and names say nothing are known by their pixels: they are drawn, and not taken.
#[test]
fn masks_of_any_name() {
    for (image, name) in [
        ("a.jpg", "task-1-annotation-1-by-1-tag-fish-0.png"),
        ("Bilder/a.png", "Beschriftet/x.png"),
        ("i0_mask.jpg", "i0_mask.png"),
        ("a_leftImg8bit.png", "a_colours.png"),
    ] {
        let run = with_images(&[image]);
        mask(&run, name);
        refused(&run, &[&format!("1 .png like masks ({name})")]);
    }
    // Where all images are drawn, there are no others that they could be masks of.
    let run = with_images(&[]);
    mask(&run, "a.png");
    mask(&run, "b.png");
    let said = augmented(&run).stdout;
    assert!(said.contains("2 images"), "{said}");
}
