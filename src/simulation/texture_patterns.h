#pragma once

#include "camera_self_calibration/simulation/canvas.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {

// Each fills a canvas whose ground already has the mean gray.

void paintPlain(double gray, Canvas* canvas, Random* random);
void paintPlaster(double gray, Canvas* canvas, Random* random);
void paintBricks(double gray, Canvas* canvas, Random* random);
void paintPanels(double gray, Canvas* canvas, Random* random);
void paintPlanks(double gray, Canvas* canvas, Random* random);
void paintTiles(double gray, Canvas* canvas, Random* random);
void paintCarpet(double gray, Canvas* canvas, Random* random);
void paintPoster(double gray, Canvas* canvas, Random* random);
void paintBooks(double gray, Canvas* canvas, Random* random);
void paintCrate(double gray, Canvas* canvas, Random* random);

}  // namespace camera_self_calibration
