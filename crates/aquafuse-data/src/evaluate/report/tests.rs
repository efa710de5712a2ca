use super::*;

/// A report whose names hold what each format could trip over.
fn report() -> Report {
    let score = Score { key: "ssim", title: "SSIM", digits: 2, shown: Shown::MeanAndVariance };
    let summary = |mean| Summary {
        count: 3,
        left_out: 1,
        mean,
        variance: 0.25,
        interval: Some([mean - 0.1, mean + 0.1]),
    };
    let row =
        |label: &str, mean| Row { labels: vec![label.into()], cells: vec![Cell::Summary(summary(mean))] };
    Report {
        command: "evaluate fusion",
        title: "A & B".into(),
        about: vec!["What `z` is".into()],
        settings: serde_json::json!({ "seed": 3, "methods": ["a", "b"], "pairs": null }),
        tables: vec![Table {
            name: "likeness",
            title: "Scores".into(),
            labels: vec!["method"],
            scores: vec![score],
            rows: vec![row("<script>, \"quoted\" | piped", 0.5), row("`plain`", 0.75)],
        }],
        items: Items {
            labels: vec!["content"],
            scores: vec![score],
            rows: vec![ItemsRow { labels: vec!["a,b\"c".into()], values: vec![Some(f64::INFINITY)] }],
        },
        failed: vec![Failed { name: "x.png".into(), error: "it is <empty>".into() }],
        gallery: vec![Strip {
            caption: "best".into(),
            images: vec![("a".into(), Image::from_raw(8, 8, vec![90; 192]).unwrap())],
        }],
    }
}

#[test]
fn markdown_keeps_its_cells_apart() {
    let text = markdown(&report());
    assert!(
        text.contains("| \\<script\\>, \"quoted\" \\| piped | 0.50 ± 0.25 (0.40 to 0.60); 1 left out |"),
        "{text}"
    );
    assert!(text.contains("methods a, b; seed 3") && text.contains("- x.png: it is \\<empty\\>"), "{text}");
    let mut odd = report();
    odd.tables[0].rows[0].labels = vec!["a\\|b\n[x](y)`".into()];
    let text = markdown(&odd);
    assert!(text.contains("| a\\\\\\|b\\\\n\\[x\\](y)\\` |") && text.contains("| `plain` |"), "{text}");
}

#[test]
fn csv_quotes_what_holds_its_signs() {
    let text = csv_of_tables(&report());
    assert!(
        text.contains("likeness,\"<script>, \"\"quoted\"\" | piped\",ssim,3,1,0.5,0.25,0.4,0.6\n"),
        "{text}"
    );
    assert_eq!(csv_of_items(&report().items), "content,ssim\n\"a,b\"\"c\",inf\n");
    let mut odd = report();
    odd.items.rows[0] = ItemsRow { labels: vec!["=1+1".into()], values: vec![Some(-1.0)] };
    assert_eq!(csv_of_items(&odd.items), "content,ssim\n'=1+1,-1\n");
}

#[test]
fn json_holds_every_figure_and_null_for_what_is_infinite() {
    let document: Value = serde_json::from_str(&json(&report())).unwrap();
    let row = &document["tables"][0]["rows"][1];
    assert_eq!((&row["method"], &row["ssim"]["mean"]), (&Value::from("`plain`"), &Value::from(0.75)));
    assert_eq!(document["items"][0]["ssim"], Value::Null);
    assert_eq!(document["failed"][0]["error"], "it is <empty>");
}

#[test]
fn no_name_becomes_a_part_of_the_page() {
    let page = html(&report());
    assert!(
        !page.contains("<script>") && page.contains("&lt;script&gt;") && page.contains("it is &lt;empty&gt;")
    );
    assert!(page.contains("<td><code>plain</code></td>") && page.contains("<title>A &amp; B</title>"));
    assert_eq!(page.matches("<svg").count(), 1);
}

#[test]
fn the_name_says_the_format_and_nothing_is_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["a.md", "a.CSV", "a.json", "a.html"] {
        write(&report(), &path(name), false).unwrap();
        assert!(check_name(&path(name), false).is_err() && check_name(&path(name), true).is_ok());
    }
    assert!(check_name(&path("a.pdf"), false).is_err());
    std::fs::create_dir(path("all")).unwrap();
    write(&report(), &path("all"), false).unwrap();
    let mut names: Vec<_> = std::fs::read_dir(path("all"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["items.csv", "report.csv", "report.html", "report.json", "report.md"]);
}
