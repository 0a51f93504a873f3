"""Generated ground truth: atria and feature maps whose properties are known beforehand."""
