//! Real cameras: what COLMAP found in images of a pool.

use std::path::PathBuf;

use aquafuse_data::image_file::ReadOptions;
use aquafuse_scene::files::read_cameras;

#[test]
fn points_of_a_real_model_lie_in_view_of_its_cameras() {
    let Some(data) = std::env::var_os("AQUAFUSE_TEST_DATA").map(PathBuf::from) else {
        println!("skipped: AQUAFUSE_TEST_DATA names no folder of real images");
        return;
    };
    let scene = data.join("sequence_subvo_pool");
    if !scene.is_dir() {
        println!("skipped: {} is not there", scene.display());
        return;
    }
    let found = read_cameras(&scene, &ReadOptions::default()).unwrap();
    assert_eq!((found.images.len(), found.points.len()), (18, 3452));
    assert!(found.images.windows(2).all(|two| two[0].name < two[1].name));
    for one in &found.images {
        let camera = &one.lens.camera;
        assert_eq!((camera.width, camera.height), (1280, 720));
        let in_view = found.points.iter().filter(|point| {
            let seen = camera.to_camera(point.position);
            let place = [0, 1].map(|a| camera.focal[a] * seen[a] / seen[2] + camera.centre[a]);
            let [x, y] = one.lens.distorted(place);
            seen[2] > 0.0 && (0.0..1280.0).contains(&x) && (0.0..720.0).contains(&y)
        });
        assert!(in_view.count() > 500, "{}", one.name.display());
    }
}
