/* A wheelset in plain C, as one writes it by hand: a table over the shift, one creep law, no flange, no
 * free rotation. Inputs: y, yaw, vy, wz, speed, loads. */
enum { NODES = 256, COLUMNS = 13, GRID = 20 };

static double table[NODES][2 * COLUMNS]; /* values and slopes */
static const double STEP = 1e-4, FIRST = -0.0128, R0 = 0.4191, LY = 0.7556, MU = 0.4, SHEAR = 82e9;

static void plain_prepare(void) {
    for (int i = 0; i < NODES; i++) {
        double x = FIRST + STEP * i;
        double value[COLUMNS] = {0.05 * x / R0, 1 + 0.05 * x / R0, 0.05, 1, 0.05 / R0, LY - x, -LY,
                                 1.9e-4, 1.6e-4, 1.2e-7, 1.1e-7, 1e-11, 1e-15};
        for (int k = 0; k < COLUMNS; k++) table[i][2 * k] = value[k];
        table[i][1] = 0.05 / R0, table[i][3] = 0.05 / R0, table[i][11] = -1.0;
    }
}

static void look_up(double shift, double *at) {
    double place = (shift - FIRST) / STEP;
    int node = place < 0 ? 0 : place > NODES - 2 ? NODES - 2 : (int)place;
    double t = place - node, s = 1 - t;
    double h0 = (1 + 2 * t) * s * s, h1 = t * t * (3 - 2 * t), g0 = STEP * t * s * s, g1 = -STEP * t * t * s;
    const double *left = table[node], *right = table[node + 1];
    for (int k = 0; k < COLUMNS; k++)
        at[k] = h0 * left[2 * k] + h1 * right[2 * k] + g0 * left[2 * k + 1] + g1 * right[2 * k + 1];
}

static void polach_by_hand(const double *c, double spin, double n, const double *at, double *f) {
    double s = cbrt(n * 0.72 / SHEAR), a = s * at[7], b = s * at[8], g = SHEAR * s * s;
    double edge = fmax(fabs(c[1]), fabs(c[1] + spin * a)), e = sqrt(c[0] * c[0] + edge * edge + 1e-16);
    double x = g * at[9] * c[0], y = g * at[10] * c[1];
    double stiff = sqrt((x * x + y * y) / (c[0] * c[0] + c[1] * c[1] + 1e-16)), limit = MU * n;
    double eps = M_PI / 4 * stiff * e / limit;
    double force = 2 / M_PI * limit * (eps / (1 + eps * eps) + atan(0.4 * eps));
    double h = 1 + 6.3 * (1 - exp(-a / b)), q = 8. / 3 * g * s * at[11] / a * edge / (limit * h), q2 = q * q;
    double delta = (q2 - 1) / (q2 + 1), m = q * (delta * delta * delta / 3 - delta * delta / 2 + 1. / 6);
    double root = 2 * q / (1 + q2);
    double by_spin = -9. / 16 * limit * h * (m - root * root * root / 3);
    f[0] = -force * c[0] / e;
    f[1] = -force * c[1] / e - by_spin * a * spin / e;
}

static void fastsim_by_hand(const double *c, double spin, double n, const double *at, double *f) {
    double s = cbrt(n * 0.72 / SHEAR), a = s * at[7], b = s * at[8], g = SHEAR * s * s, p0 = 2 * n / (M_PI * a * b);
    double l1 = 8 * a * a * b / (3 * g * at[9]), l2 = 8 * a * a * b / (3 * g * at[10]);
    double l3 = M_PI * a * a * a * b / (4 * g * s * at[11]);
    f[0] = f[1] = 0;
    for (int j = 0; j < GRID; j++) {
        double y = (2 * j + 1. - GRID) / GRID, half = sqrt(1 - y * y), dx = 2 * a * half / GRID, px = 0, py = 0;
        for (int i = 0; i < GRID; i++) {
            double z = half * (1 - (2 * i + 1.) / GRID);
            px -= dx * (c[0] / l1 - spin * y * b / l3), py -= dx * (c[1] / l2 + spin * z * a / l3);
            double bound = MU * p0 * (1 - z * z - y * y), size = sqrt(px * px + py * py);
            if (size > bound) px *= bound / size, py *= bound / size;
            f[0] += px * dx, f[1] += py * dx;
        }
    }
    f[0] *= 2 * b / GRID, f[1] *= 2 * b / GRID;
}

static double plain(int law, const double *u) {
    double force = 0, moment = 0, common = u[2] / u[4] - u[1], turn = u[3] / u[4];
    for (int side = 0; side < 2; side++) {
        double sign = side ? -1 : 1, n = u[5 + side], at[COLUMNS], f[2];
        if (law == 1) {
            f[0] = 7.3e6 * sign * (0.05 * u[0] / R0 + LY * turn), f[1] = -7.3e6 * common;
            force += f[1] - n * 0.05 / LY * u[0], moment -= sign * LY * f[0];
            continue;
        }
        look_up(sign * u[0], at);
        double c[2] = {-at[0] - sign * at[5] * turn, common / at[3]}, spin = turn - sign * at[4];
        (law == 4 ? polach_by_hand : fastsim_by_hand)(c, spin, n, at, f);
        force += f[1] * at[3] - sign * n * at[2] / at[3], moment -= sign * at[5] * f[0];
    }
    return force + moment;
}
