//! The page that shows a scene, in a real browser: it draws what `aquafuse scene render` draws.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod run;

use std::process::Command;

use aquafuse::metrics::psnr;
use aquafuse_data::image_file::ImageFile;
use run::{Run, reef};

/// Browsers that take images of pages, as they are called.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

fn browser() -> Option<&'static str> {
    BROWSERS
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|ended| ended.status.success()))
}

#[test]
fn the_page_needs_nothing_else_and_is_not_written_over() {
    let run = Run::new();
    reef(&run);
    run.ok(&["scene", "train", "reef", "-o", "a&b.ply", "--iterations", "20"]);
    run.ok(&["scene", "view", "a&b.ply", "reef", "-o", "reef.html"]);
    let page = String::from_utf8(run.bytes("reef.html")).unwrap();
    assert!(page.contains("<title>a&amp;b.ply</title>") && page.contains("view_008.png"));
    assert!(page.contains("default-src 'none'") && !page.contains("src=") && !page.contains("href="));
    assert!(!page.contains("{{"), "a place was left open");
    run.fails(2, &["scene", "view", "a&b.ply", "reef", "-o", "reef.html"]);
    run.fails(2, &["scene", "view", "a&b.ply", "reef", "-o", "reef.htm"]);
    let alone = run.ok(&["scene", "view", "a&b.ply", "-o", "alone.html"]).stdout;
    assert!(alone.ends_with("1 views\n"), "{alone}");
}

#[test]
fn a_browser_draws_what_we_draw() {
    let Some(browser) = browser() else {
        println!("skipped: none of {} is installed", BROWSERS.join(", "));
        return;
    };
    let run = Run::new();
    reef(&run);
    run.ok(&["scene", "train", "reef", "-o", "reef.ply", "--iterations", "200", "--water", "learn"]);
    run.ok(&["scene", "view", "reef.ply", "reef", "-o", "reef.html"]);
    for (water, drawn) in [("1", "wet"), ("0", "dry")] {
        let mut render = vec!["scene", "render", "reef.ply", "reef", "-o", drawn, "--longest", "480"];
        if drawn == "dry" {
            render.extend(["--water", "none"]);
        }
        run.ok(&render);
        let page = format!("file://{}#view=4&bare=1&water={water}", run.path("reef.html").display());
        let shot = run.path(&format!("{drawn}.png"));
        let ended = Command::new(browser)
            .args(["--headless", "--no-sandbox", "--hide-scrollbars", "--window-size=480,360"])
            .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--virtual-time-budget=4000"])
            .arg(format!("--user-data-dir={}", run.path("profile").display()))
            .arg(format!("--screenshot={}", shot.display()))
            .arg(page)
            .output()
            .unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
        let [seen, ours] =
            [shot, run.path(&format!("{drawn}/view_003.png"))].map(|path| ImageFile::read(&path).unwrap());
        let near = psnr(&*seen.bytes(), &*ours.bytes()).unwrap();
        println!("{drawn}: {near:.1} dB");
        assert!(near > 32.0, "{drawn}: the page is {near:.1} dB from what we draw");
    }
}
