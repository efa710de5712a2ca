use super::*;

#[test]
fn a_distance_that_is_no_number_is_named_with_its_place() {
    let error = DepthMap::from_distances(2, 2, DepthKind::Metres, vec![0.0, 1.0, f32::NAN, 1.0]).unwrap_err();
    assert!(error.to_string().starts_with("depth at column 0, row 1 is NaN"), "{error}");
}

#[test]
fn distances_out_of_range_are_refused() {
    for (kind, value) in
        [(DepthKind::Metres, -0.5), (DepthKind::Metres, f32::INFINITY), (DepthKind::Relative, 1.5)]
    {
        assert!(DepthMap::from_distances(1, 1, kind, vec![value]).is_err());
    }
}

#[test]
fn neither_open_water_nor_an_outlier_takes_the_steps_from_the_scene() {
    for far in [100.0, 65535.0] {
        let mut distances: Vec<f32> = (0..1000).map(|i| 12.0 * i as f32 / 999.0).collect();
        distances.push(far);
        let z = DepthMap::from_distances(1001, 1, DepthKind::Metres, distances).unwrap();
        let found = z.quantised();
        assert!((found.step * 254.0 - 12.0).abs() < 0.1, "{}", found.step);
        assert_eq!((found.levels[0], found.levels[1000], found.beyond), (0, 255, Some(255)));
    }
}

#[test]
fn where_all_else_is_at_the_camera_the_farthest_is_the_scale() {
    for far in [0.001, 5.0, 4000.0] {
        let z = DepthMap::from_distances(3, 1, DepthKind::Metres, vec![0.0, 0.0, far]).unwrap();
        assert_eq!(z.quantised().levels[2], 254, "{far}");
    }
}

#[test]
fn a_map_of_next_to_nothing_has_steps_to_divide_by() {
    for value in [0.0, 1e-44] {
        let z = DepthMap::from_distances(2, 1, DepthKind::Metres, vec![value; 2]).unwrap();
        assert!(z.quantised().step > 1e-30);
        assert_eq!(z.percentile(0.95), value);
    }
}
