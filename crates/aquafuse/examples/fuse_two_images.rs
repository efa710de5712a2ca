//! cargo run --release -p aquafuse --features image --example fuse_two_images -- CONTENT REFERENCE OUTPUT

use aquafuse::Fuser;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut paths = std::env::args().skip(1);
    let mut path = || paths.next().ok_or("give CONTENT REFERENCE OUTPUT");
    let content = image::open(path()?)?.into_rgb8();
    let reference = image::open(path()?)?.into_rgb8();

    let fused = Fuser::new(&reference)?.fuse(&content)?;
    println!("content: {:?}, bounds: {:?}", fused.report.content.quality.verdict, fused.report.bounds);
    Ok(image::RgbImage::from(fused.image).save(path()?)?)
}
