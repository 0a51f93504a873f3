"""Triangle surfaces of heart chambers: files, soundness, repair, capping, simplification."""
