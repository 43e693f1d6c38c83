// Locates the neighbours in one grey image without a header: locate CAMERA AIRFRAME IMAGE. Its pixels are bytes, row by row, of the camera's size.

#include <photinus.h>
#include <stdio.h>
#include <stdlib.h>

#define MOST_NEIGHBOURS 32

static void must(PhotinusStatus status) {
    if (status != PHOTINUS_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", photinus_status_name((int32_t)status), photinus_error());
        exit(EXIT_FAILURE);
    }
}

int main(int argc, char **argv) {
    if (argc != 4) {
        fprintf(stderr, "usage: locate CAMERA AIRFRAME IMAGE\n");
        return EXIT_FAILURE;
    }
    PhotinusCamera camera = {0};
    PhotinusAirframe airframe = {0};
    PhotinusLocator locator = {0};
    PhotinusOptions options;
    must(photinus_read_camera(argv[1], &camera));
    must(photinus_read_airframe(argv[2], &airframe));
    must(photinus_default_options(&options));
    must(photinus_open_locator(camera, airframe, &options, &locator));

    size_t width = 0, height = 0;
    must(photinus_camera_size(camera, &width, &height));
    uint8_t *pixels = malloc(width * height);
    FILE *file = fopen(argv[3], "rb");
    if (pixels == NULL || file == NULL || fread(pixels, 1, width * height, file) != width * height) {
        fprintf(stderr, "%s holds no image of %zux%zu bytes\n", argv[3], width, height);
        return EXIT_FAILURE;
    }
    fclose(file);

    PhotinusImage image = {pixels, width, height, (ptrdiff_t)width};
    const double down[3] = {0, 1, 0};
    PhotinusFrame frame;
    must(photinus_locate(locator, &image, down, NULL, &frame));

    PhotinusNeighbour neighbours[MOST_NEIGHBOURS];
    size_t count = 0;
    must(photinus_neighbours(locator, neighbours, MOST_NEIGHBOURS, &count));
    printf("%zu spots, %zu neighbours\n", frame.spots, count);
    for (size_t i = 0; i < count && i < MOST_NEIGHBOURS; ++i) {
        const PhotinusNeighbour *seen = &neighbours[i];
        printf("%.2f +- %.2f m, between %.2f and %.2f m, towards (%.3f, %.3f, %.3f), probability %.3f\n", seen->distance_m,
               seen->distance_sigma_m, seen->distance_min_m, seen->distance_max_m, seen->bearing[0], seen->bearing[1],
               seen->bearing[2], seen->probability);
    }

    free(pixels);
    must(photinus_close_locator(locator));
    must(photinus_close_airframe(airframe));
    must(photinus_close_camera(camera));
    return EXIT_SUCCESS;
}
