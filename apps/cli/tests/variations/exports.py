"""What labelling tools export and what published underwater datasets look like, as further sets."""

import gzip
import json
import zipfile
import io

from sets import HEIGHT, LABEL, WIDTH, Set, coco, labelme, mask, picture, tar, voc

VIA = {"i0.jpg600": {"filename": "i0.jpg", "size": 600, "regions": [{"shape_attributes": {"name": "rect", "x": 1}}]}}
KITTI = b"Fish 0.00 0 0.00 1.0 2.0 31.0 22.0 0 0 0 0 0 0 0\n"
DOTA = b"imagesource:x\ngsd:0.1\n1 1 30 1 30 20 1 20 fish 0\n"


def dumps(value):
    return json.dumps(value).encode()


def archive(name, content):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as zipped:
        zipped.writestr(name, content)
    return buffer.getvalue()


def roboflow():
    """The exports of Roboflow: a folder for each split, README files at the top."""
    splits = ["train", "valid", "test"]
    stem = lambda split: f"{split}_png.rf.0a1b"

    def exported(write):
        made = Set().other("README.dataset.txt").other("README.roboflow.txt", b"Resize to 640x640 (Fit (black edges))\n")
        for split in splits:
            write(made, split, stem(split))
        return made

    def plain(end, content):
        return exported(lambda made, split, name: made.image(f"{split}/{name}.jpg").label(content(f"{name}.jpg"), f"{split}/{end}"))

    def per_image(end, content):
        return exported(lambda made, split, name: made.image(f"{split}/{name}.jpg").label(content(f"{name}.jpg"), f"{split}/{name}{end}"))

    yolo = exported(lambda made, split, name: made.image(f"{split}/images/{name}.jpg").label(LABEL, f"{split}/labels/{name}.txt"))
    yolo.label(b"train: ../train/images\nval: ../valid/images\ntest: ../test/images\n\nnc: 1\nnames: ['fish']\n", "data.yaml")
    obb = exported(lambda made, split, name: made.image(f"{split}/images/{name}.jpg").label(b"1 1 30 1 30 20 1 20 fish 0\n", f"{split}/labelTxt/{name}.txt"))
    masks = exported(lambda made, split, name: made.image(f"{split}/{name}.jpg").mask(f"{split}/{name}_mask.png").label(b"Pixel Value, Class\n0, background\n1, fish\n", f"{split}/_classes.csv"))
    darknet = per_image(".txt", lambda name: LABEL)
    for split in splits:
        darknet.label(b"fish\n", f"{split}/_darknet.labels")
    return {
        "roboflow_coco": plain("_annotations.coco.json", lambda name: coco([name])),
        "roboflow_yolo": yolo,
        "roboflow_darknet": darknet,
        "roboflow_voc": per_image(".xml", lambda name: voc(name).encode()),
        "roboflow_csv": plain("_annotations.csv", lambda name: f"filename,width,height,class,xmin,ymin,xmax,ymax\n{name},96,72,fish,1,1,30,20\n".encode()),
        "roboflow_createml": plain("_annotations.createml.json", lambda name: dumps([{"image": name, "annotations": [{"label": "fish", "coordinates": {"x": 1}}]}])),
        "roboflow_tfrecord": plain("fish.tfrecord", lambda name: b"\x08\0\0\0" + picture(name)),
        "roboflow_keras": plain("_annotations.txt", lambda name: f"{name} 1,1,30,20,0\n".encode()),
        "roboflow_multiclass": plain("_classes.csv", lambda name: f"filename, fish\n{name}, 1\n".encode()),
        "roboflow_obb": obb,
        "roboflow_masks": masks,
    }


def cvat():
    """CVAT and datumaro."""
    image = lambda path: Set().image(path)
    item = {"categories": {}, "items": [{"id": "i0", "annotations": [], "image": {"path": "i0.jpg"}}]}
    return {
        "cvat_coco": image("images/default/i0.jpg").label(coco(["i0.jpg"]), "annotations/instances_default.json"),
        "cvat_yolov8": image("images/train/i0.jpg").label(LABEL, "labels/train/i0.txt").label(b"images/train/i0.jpg\n", "train.txt").label(b"names:\n  0: fish\npath: .\ntrain: train.txt\n", "data.yaml"),
        "cvat_voc": image("JPEGImages/i0.jpg").label(voc("i0.jpg").encode(), "Annotations/i0.xml").label(b"i0\n", "ImageSets/Main/default.txt").label(b"# label:color_rgb:parts:actions\nfish:::\n", "labelmap.txt"),
        "cvat_masks": image("JPEGImages/i0.jpg").mask("SegmentationClass/i0.png", "SegmentationObject/i0.png", colours=True).label(b"i0\n", "ImageSets/Segmentation/default.txt"),
        "cvat_camvid": image("default/i0.png").mask("defaultannot/i0.png").label(b"/default/i0.png /defaultannot/i0.png\n", "default.txt").other("label_colors.txt", b"0 0 0 background\n"),
        "cvat_mot": image("img1/000001.jpg").label(b"1,1,1,1,30,20,1,1,1\n", "gt/gt.txt").label(b"fish\n", "gt/labels.txt"),
        "cvat_mots": image("train/images/000001.jpg").mask("train/instances/000001.png").label(b"fish\n", "train/instances/labels.txt"),
        "cvat_kitti": image("default/image_2/i0.png").label(KITTI, "default/label_2/i0.txt").mask("default/instance/i0.png"),
        "cvat_icdar": image("train/images/i0.jpg").label(b"1,1,30,20,\"fish\"\n", "train/gt/gt_i0.txt"),
        "cvat_labelme3": image("default/i0.jpg").label(b"<annotation><filename>i0.jpg</filename><folder>default</folder><object><name>fish</name><polygon><pt><x>1</x><y>1</y></pt></polygon></object></annotation>", "default/i0.xml"),
        "cvat_widerface": image("WIDER_train/images/0--fish/0_fish_i0.jpg").label(b"0--fish/0_fish_i0.jpg\n1\n1 1 30 20 0 0 0 0 0 0\n", "wider_face_split/wider_face_train_bbx_gt.txt"),
        "cvat_vgg": image("train/n1/i0.jpg").label(b"NAME_ID,X,Y,W,H\nn1/i0,1,1,30,20\n", "bb_landmark/loose_bb_train.csv"),
        "cvat_openimages": image("images/train/i0.jpg").label(b"ImageID,Source,LabelName,Confidence,XMin\ni0,x,/m/0,1,0.1\n", "annotations/train-annotations-bbox.csv"),
        "cvat_cityscapes": image("imgsFine/leftImg8bit/default/i0_leftImg8bit.png").mask("gtFine/default/i0_gtFine_labelIds.png", "gtFine/default/i0_gtFine_color.png"),
        "datumaro": image("images/default/i0.jpg").label(dumps(item), "annotations/default.json"),
        "cvat_video": image("frames/frame_000000.PNG").label(b"<annotations><track id=\"0\" label=\"fish\"><box frame=\"0\" xtl=\"1\"/></track></annotations>", "annotations.xml"),
    }


def tools():
    """FiftyOne, Label Studio, Supervisely, LabelMe, VIA, VoTT and other tools."""
    image = lambda *paths: Set().image(*paths)
    task = [{"id": 1, "data": {"image": "/data/upload/1/i0.jpg"}, "annotations": [{"result": [{"type": "rectanglelabels"}]}]}]
    fiftyone = {"samples": [{"filepath": "data/i0.jpg", "ground_truth": {"detections": [{"label": "fish", "bounding_box": [0.1, 0.1, 0.2, 0.2]}]}}]}
    drawn = {"description": "", "size": {"height": HEIGHT, "width": WIDTH}, "objects": [{"classTitle": "fish", "points": {"exterior": [[1, 1]]}}]}
    asset = {"asset": {"name": "i0.jpg", "path": "file:C:/x/i0.jpg"}, "regions": [{"tags": ["fish"], "boundingBox": {"left": 1}}]}
    return {
        "fiftyone_coco": image("data/i0.jpg", "data/i1.jpg").label(coco(["i0.jpg", "i1.jpg"]), "labels.json"),
        "fiftyone_dataset": image("data/i0.jpg").label(dumps(fiftyone), "samples.json").other("metadata.json", b"{\"media_type\": \"image\"}"),
        "fiftyone_detection": image("data/i0.jpg").label(dumps({"classes": ["fish"], "labels": {"i0": [{"label": 0, "bounding_box": [0.1, 0.1, 0.2, 0.2]}]}}), "labels.json"),
        "fiftyone_yolo5": image("images/val/i0.jpg").label(LABEL, "labels/val/i0.txt").label(b"names:\n  0: fish\nval: ./images/val/\n", "dataset.yaml"),
        "fiftyone_yolo4": image("data/i0.jpg").label(LABEL, "data/i0.txt").label(b"fish\n", "obj.names").label(b"data/i0.jpg\n", "images.txt"),
        "fiftyone_voc": image("data/i0.jpg").label(voc("i0.jpg").encode(), "labels/i0.xml"),
        "fiftyone_cvat": image("data/i0.jpg").label(b"<annotations><image id=\"0\" name=\"i0.jpg\"/></annotations>", "labels.xml"),
        "fiftyone_masks": image("data/i0.jpg").mask("labels/i0.png"),
        "fiftyone_bdd": image("data/i0.jpg").label(dumps([{"name": "i0.jpg", "labels": [{"category": "fish", "box2d": {"x1": 1}}]}]), "labels.json"),
        "labelstudio_json": image("images/i0.jpg").label(dumps(task), "project-1-at-2024.json"),
        "labelstudio_csv": image("images/i0.jpg").label(b"image,id,label\n/data/i0.jpg,1,\"[{\"\"x\"\": 1}]\"\n", "project-1.csv"),
        "labelstudio_coco": image("images/5d8f-i0.jpg").label(coco(["images/5d8f-i0.jpg"]), "result.json"),
        "labelstudio_coco_windows": image("images/5d8f-i0.jpg").label(coco(["..\\..\\label-studio\\data\\media\\upload\\1\\5d8f-i0.jpg"]), "result.json"),
        "labelstudio_yolo": image("images/5d8f-i0.jpg").label(LABEL, "labels/5d8f-i0.txt").label(b"fish\n", "classes.txt").label(b"{\"categories\": [{\"id\": 0, \"name\": \"fish\"}]}", "notes.json"),
        "labelstudio_voc": image("images/i0.jpg").label(voc("i0.jpg").encode(), "Annotations/i0.xml"),
        "labelstudio_brush": image("images/i0.jpg").mask("task-1-annotation-1-by-1-tag-fish-0.png"),
        "labelstudio_yolo_no_images": Set().label(LABEL, "labels/i0.txt").label(b"fish\n", "classes.txt"),
        "supervisely": image("ds0/img/i0.jpg").label(dumps(drawn), "ds0/ann/i0.jpg.json").label(dumps({"classes": []}), "meta.json"),
        "supervisely_masks": image("ds0/img/i0.jpg").label(dumps(drawn), "ds0/ann/i0.jpg.json").mask("ds0/masks_machine/i0.png", "ds0/seg/i0.jpg.png"),
        "labelme_folder": image("images/i0.jpg").label(labelme("..\\images\\i0.jpg"), "labels/i0.json"),
        "labelme_voc": image("JPEGImages/i0.jpg").mask("SegmentationClassPNG/i0.png").label(b"\x93NUMPY", "SegmentationClass/i0.npy").mask("SegmentationClassVisualization/i0.jpg", colours=True).label(b"_background_\nfish\n", "class_names.txt"),
        "via_json": image("i0.jpg").label(dumps(VIA), "via_region_data.json"),
        "via_csv": image("i0.jpg").label(b"filename,file_size,region_shape_attributes\ni0.jpg,6,\"{}\"\n", "via_region_data.csv"),
        "vott": image("i0.jpg").label(dumps(asset), "0a1b2c-asset.json"),
        "vott_project": image("i0.jpg").label(dumps({"name": "x", "assets": {"0a": asset}}), "fish-export.json"),
        "makesense_csv": image("i0.jpg").label(b"fish,1,1,30,20,i0.jpg,96,72\n", "labels_fish.csv"),
        "labelbox": image("i0.jpg").label(b"{\"data_row\": {\"external_id\": \"i0.jpg\"}}\n", "export.ndjson"),
        "scale": image("i0.jpg").label(dumps([{"params": {"attachment": "i0.jpg"}, "response": {"annotations": []}}]), "tasks.json"),
        "sagemaker": image("i0.jpg").label(b"{\"source-ref\": \"s3://b/i0.jpg\", \"boxes\": {}}\n", "output.manifest"),
        "darwin": image("images/i0.jpg").label(dumps({"version": "2.0", "item": {"name": "i0.jpg"}, "annotations": []}), "annotations/i0.json"),
        "huggingface_folder": image("train/i0.jpg").label(b"{\"file_name\": \"i0.jpg\", \"objects\": {\"bbox\": []}}\n", "train/metadata.jsonl"),
        "huggingface_csv": image("train/i0.jpg").label(b"file_name,text\ni0.jpg,two fish\n", "train/metadata.csv"),
        "openpose": image("i0.jpg").label(dumps({"people": [{"pose_keypoints_2d": [1, 2, 1]}]}), "i0_keypoints.json"),
        "points_txt": image("i0.jpg").label(b"12.5 30.25\n40 41\n", "i0_points.txt"),
        "captions_beside": image("i0.png", "i1.png").label(b"a fish over sand", "i0.txt", "i1.txt"),
        "captions_extension": image("i0.png").label(b"a fish over sand", "i0.caption"),
        "classification_folders": image("fish/i0.jpg", "sand/i1.jpg"),
        "classification_list": image("images/i0.jpg").label(b"images/i0.jpg 3\n", "train_list.txt"),
        "imagenet_txt": image("val/i0.jpg").label(b"i0.jpg 3\n", "val.txt"),
        "squashed": image("images/i0.jpg").label(gzip.compress(coco(["i0.jpg"])), "instances.json.gz"),
        "zipped": image("images/i0.jpg").label(archive("i0.txt", LABEL), "labels.zip"),
        "lmdb": image("images/i0.jpg").label(b"\0" * 64, "train.lmdb/data.mdb"),
        "python_pickle": image("images/i0.jpg").label(b"\x80\x04]\x94.", "train.pkl"),
        "yaml_boxes": image("images/i0.jpg").label(b"boxes:\n- [1, 2, 3, 4]\n", "annotations/i0.yaml"),
        "gamma_npz": image("images/i0.jpg").label(b"PK\x03\x04", "depth/i0.npz"),
        "trimap": image("images/i0.jpg").mask("annotations/trimaps/i0.png").label(b"i0 1 1 1\n", "annotations/list.txt"),
        "shards_two": Set().label(tar([("a.jpg", picture("a.jpg")), ("a.json", b"{}")]), "s0.tar").label(tar([("b.png", picture("b.png")), ("b.cls", b"1")]), "s1.tar"),
        "shards_masks": Set().label(tar([("a.jpg", picture("a.jpg")), ("a.mask.png", mask("a.png"))]), "s0.tar"),
        "shards_img2dataset": Set().label(tar([("000000000.jpg", picture("a.jpg")), ("000000000.json", b"{\"key\": \"000000000\"}"), ("000000000.txt", b"fish")]), "00000.tar").label(dumps({"count": 1}), "00000_stats.json").label(b"PAR1", "00000.parquet"),
    }


def published():
    """Published datasets of underwater images, by their folders and names."""
    image = lambda *paths: Set().image(*paths)
    frame = "2019-02-20_19-01-02to2019-02-20_19-01-13_1-0001"
    return {
        "deepfish_classification": image("Classification/7117/valid/i0.jpg", "Classification/7117/empty/i1.jpg").label(b"ID,labels\n7117/valid/i0,1\n", "Classification/train.csv"),
        "deepfish_localization": image("Localization/images/valid/i0.jpg").mask("Localization/masks/valid/i0.png").label(b"ID,counts\nvalid/i0,1\n", "Localization/train.csv"),
        "trashcan_original": image("original_data/images/vid_1_frame0001.jpg").label(dumps({"annotations": [], "name": "vid_1_frame0001.jpg"}), "original_data/annotations/vid_1_frame0001.json"),
        "trashicra": image("train/bio0004_frame0000028.jpg").label(voc("bio0004_frame0000028.jpg").encode(), "train/bio0004_frame0000028.xml").label(LABEL, "train/bio0004_frame0000028.txt"),
        "suim": image("train_val/images/d_r_1_.jpg").mask("train_val/masks/d_r_1_.bmp", colours=True),
        "suim_test": image("TEST/images/d_r_2_.jpg").mask("TEST/masks/d_r_2_.bmp", colours=True).mask("TEST/masks/FV/d_r_2_.bmp", "TEST/masks/HD/d_r_2_.bmp"),
        "uiis": image("UDW/train/L_1.jpg", "UDW/val/L_2.jpg").label(coco(["L_1.jpg"]), "UDW/annotations/train.json").label(coco(["L_2.jpg"]), "UDW/annotations/val.json"),
        "uiis10k": image("img/L_1.jpg").label(coco(["L_1.jpg"]), "annotations/multiclass_train.json"),
        "usis10k": image("train/train_00001.jpg").label(coco(["train_00001.jpg"]), "foreground_annotations/foreground_train_annotations.json").label(coco(["train_00001.jpg"]), "multi_class_annotations/multi_class_train_annotations.json"),
        "brackish_coco": image(f"dataset/img/{frame}.png").label(coco([f"{frame}.png"]), "annotations/annotations_COCO/train_groundtruth.json"),
        "brackish_yolo": image(f"data/{frame}.png").label(LABEL, f"data/{frame}.txt").label(f"data/{frame}.png\n".encode(), "train.txt").label(b"fish\n", "brackish.names").label(b"classes=1\ntrain=train.txt\n", "brackish.data"),
        "brackish_aau": image(f"dataset/img/{frame}.png").label(f"Filename;Object ID;Annotation tag;Upper left corner X\n{frame}.png;1;fish;1\n".encode(), "annotations/annotations_AAU/annotations.csv"),
        "duo": image("images/train/1.jpg", "images/test/2.jpg").label(coco(["1.jpg"]), "annotations/instances_train.json").label(coco(["2.jpg"]), "annotations/instances_test.json"),
        "urpc": image("train/image/000001.jpg").label(voc("000001").encode(), "train/box/000001.xml"),
        "udd": image("JPEGImages/train/1.jpg").label(voc("1.jpg").encode(), "Annotations/train/1.xml").label(b"1\n", "ImageSets/Main/train.txt"),
        "utdac": image("train2017/000001.jpg").label(coco(["000001.jpg"]), "annotations/instances_train2017.json"),
        "seaclear": image("bistrina/100/i0.jpg").label(coco(["i0.jpg"]), "dataset.json"),
        "seaclear_paths": image("bistrina/100/i0.jpg").label(coco(["bistrina/100/i0.jpg"]), "dataset.json"),
        "coralnet": image("images/i0.jpg").label(b"Name,Row,Column,Label\ni0.jpg,10,20,coral\n", "annotations.csv"),
        "squidle": image("i0.jpg").label(b"label.name\tpoint.x\tmedia.key\nfish\t1\ti0\n", "annotation_set.tsv"),
        "viame": image("i0.png").label(b"# 1: Detection,2: Image,3: Frame\n0,i0.png,0,1,1,30,20,1,0,fish,1\n", "annotations.viame.csv"),
        "ozfish": image("frames/A000001_L.avi.5107.png").label(b"{\"source-ref\":\"A000001_L.avi.5107.png\"}\n", "frames.manifest"),
        "fish4knowledge": image("fish_image/fish_01/fish_000000001.png").mask("mask_image/mask_01/mask_000000001.png"),
        "ndd20": image("ABOVE/1.jpg").label(dumps(VIA), "ABOVE_LABELS.json"),
        "f4k_mat": image("images/i0.jpg").label(b"MATLAB 5.0", "gt.mat"),
        "lsui": image("input/1.jpg", "GT/1.jpg"),
        "uieb": image("raw-890/1_img_.png", "reference-890/1_img_.png"),
        "euvp": image("Paired/underwater_dark/trainA/i0.jpg", "Paired/underwater_dark/trainB/i0.jpg"),
        "flsea": image("canyons/flatiron/imgs/16233051861828957.tiff").mask("canyons/flatiron/depth/16233051861828957.tif"),
        "seathru": image("D3/Raw_png/T_S04856.png").mask("D3/depth/depthT_S04856.tif"),
        "caveseg": image("train/images/i0.jpg").mask("train/masks_rgb/i0.png", colours=True).mask("train/labels/i0.png"),
        "usod": image("USOD10K/TR/RGB/00001.png").mask("USOD10K/TR/GT/00001.png", "USOD10K/TR/depth/00001.png"),
        "ufo120": image("train_val/hr/i0.jpg", "train_val/lrd/i0.jpg").mask("train_val/mask/i0.jpg"),
        "fathomnet": image("images/0a1b.png").label(coco(["0a1b.png"]), "train.json").label(b"annotation_id,categories\n1,1\n", "annotations.csv"),
        "marine_debris": image("images/marine-debris-aris3k-0.png").label(voc("marine-debris-aris3k-0.png").encode(), "annotations/marine-debris-aris3k-0.xml").mask("masks/marine-debris-aris3k-0.png"),
        "coralscapes": image("leftImg8bit/train/site1/site1_000001_leftImg8bit.png").mask("gtFine/train/site1/site1_000001_gtFine.png"),
        "benthic_csv": image("img/i0.jpg").label(b"i0.jpg;1;2;coral\n", "points.csv"),
        "mot_det": image("seq1/img1/000001.jpg").label(b"1,-1,1,1,30,20,1\n", "seq1/det/det.txt").label(b"1,1,1,1,30,20,1\n", "seq1/gt/gt.txt").other("seq1/seqinfo.ini", b"[Sequence]\n"),
        "davis": image("JPEGImages/480p/fish/00000.jpg").mask("Annotations/480p/fish/00000.png").label(b"/JPEGImages/480p/fish/00000.jpg /Annotations/480p/fish/00000.png\n", "ImageSets/480p/train.txt"),
        "got10k": image("train/seq1/00000001.jpg").label(b"1,1,30,20\n", "train/seq1/groundtruth.txt"),
        "otb": image("fish/img/0001.jpg").label(b"1\t1\t30\t20\n", "fish/groundtruth_rect.txt"),
        "kitti": image("training/image_2/000000.png").label(KITTI, "training/label_2/000000.txt").label(b"P0: 1 0 0\n", "training/calib/000000.txt"),
        "dota": image("images/i0.png").label(DOTA, "labelTxt/i0.txt"),
        "yolo_and_coco": image("images/train/i0.jpg").label(LABEL, "labels/train/i0.txt").label(coco(["i0.jpg"]), "annotations/instances_train.json"),
        "yolo_and_masks": image("images/i0.jpg").label(LABEL, "labels/i0.txt").mask("masks/i0.png"),
        "panoptic": image("val2017/i0.jpg").mask("panoptic_val2017/i0.png", colours=True).label(dumps({"images": [{"id": 1, "file_name": "i0.jpg"}], "annotations": [{"image_id": 1, "file_name": "i0.png", "segments_info": []}], "categories": []}), "panoptic_val2017.json"),
    }


def exports():
    return roboflow() | cvat() | tools() | published()
