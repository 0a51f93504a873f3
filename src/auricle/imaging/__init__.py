"""Volumes of CT and masks in them: files, geometry, segmentation."""
