"""Names of files in the manifest of a run, so that a later run replaces them and nothing else."""
import pathlib


def register(path):
    """Appends the file to `manifest.txt` of its folder; a folder without one belongs to no run."""
    path = pathlib.Path(path)
    manifest = path.parent / "manifest.txt"
    if not manifest.exists():
        return path
    text = manifest.read_text(encoding="utf-8")
    if path.name not in text.split("\n"):
        with open(manifest, "a", encoding="utf-8") as f:
            # A kill may have cut the last line short.
            f.write(("\n" if text and not text.endswith("\n") else "") + path.name + "\n")
    return path
