//! Embree 3 on the same rays, bound at run time: Debian's `libembree3-3`. Rates are comparable, hits may differ at edges.

use std::{
    ffi::{c_char, c_int, c_void},
    ptr,
};

use glossmith::scene::PACKET;

type Handle = *mut c_void;

/// `RTCIntersectContext` without motion blur or instances.
#[repr(C)]
struct Context {
    flags: c_int,
    filter: *const c_void,
    instance: u32,
}

/// `RTCRayHit` for `N` = 1 and `RTCRayHit16` for 16: each field of all rays in a row.
#[repr(C, align(64))]
struct RayHits<const N: usize> {
    origin: [[f32; N]; 3],
    t_min: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    t_max: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    coordinates: [[f32; N]; 2],
    triangle: [u32; N],
    geometry: [u32; N],
    instance: [u32; N],
}

/// `RTC_FORMAT_UINT3` and `RTC_FORMAT_FLOAT3`.
const INDICES: c_int = 0x5003;
const POSITIONS: c_int = 0x9003;
/// Context flags of rays that belong together, as those of a camera.
const COHERENT: c_int = 1;
/// Scene flags: nothing, or hits without gaps at the edges between triangles.
const FLAGS: [c_int; 2] = [0, 4];

type Trace1 = unsafe extern "C" fn(Handle, *mut Context, *mut RayHits<1>);
type Trace16 = unsafe extern "C" fn(*const c_int, Handle, *mut Context, *mut RayHits<16>);

/// A scene of one mesh in Embree.
pub struct Embree {
    scene: Handle,
    /// The closest hit, and any.
    one: [Trace1; 2],
    sixteen: [Trace16; 2],
    // Last: what is bound lives in it.
    _library: libloading::Library,
}

impl Embree {
    /// The scene, with hits without gaps between triangles if `is_robust`; `None` where the library is not installed.
    pub fn of(positions: &[[f32; 3]], triangles: &[[u32; 3]], is_robust: bool) -> Option<Self> {
        // SAFETY: the signatures are those of `rtcore.h` of version 3; the buffers are read within their sizes.
        unsafe {
            let library = libloading::Library::new("libembree3.so.3").ok()?;
            macro_rules! bind {
                ($symbol:literal: $type:ty) => {
                    *library.get::<$type>($symbol).ok()?
                };
            }
            let device = bind!(b"rtcNewDevice\0": unsafe extern "C" fn(*const c_char) -> Handle)(c"threads=1".as_ptr());
            let scene = bind!(b"rtcNewScene\0": unsafe extern "C" fn(Handle) -> Handle)(device);
            let mesh = bind!(b"rtcNewGeometry\0": unsafe extern "C" fn(Handle, c_int) -> Handle)(device, 0);
            let fill = bind!(b"rtcSetNewGeometryBuffer\0": unsafe extern "C" fn(Handle, c_int, u32, c_int, usize, usize) -> *mut c_void);
            let to = fill(mesh, 0, 0, INDICES, 12, triangles.len());
            ptr::copy_nonoverlapping(triangles.as_ptr().cast(), to, triangles.len() * 12);
            let to = fill(mesh, 1, 0, POSITIONS, 12, positions.len());
            ptr::copy_nonoverlapping(positions.as_ptr().cast(), to, positions.len() * 12);
            bind!(b"rtcCommitGeometry\0": unsafe extern "C" fn(Handle))(mesh);
            bind!(b"rtcAttachGeometry\0": unsafe extern "C" fn(Handle, Handle) -> u32)(scene, mesh);
            // `RTC_BUILD_QUALITY_HIGH`.
            bind!(b"rtcSetSceneFlags\0": unsafe extern "C" fn(Handle, c_int))(scene, FLAGS[usize::from(is_robust)]);
            bind!(b"rtcSetSceneBuildQuality\0": unsafe extern "C" fn(Handle, c_int))(scene, 2);
            bind!(b"rtcCommitScene\0": unsafe extern "C" fn(Handle))(scene);
            Some(Self {
                scene,
                one: [bind!(b"rtcIntersect1\0": Trace1), bind!(b"rtcOccluded1\0": Trace1)],
                sixteen: [bind!(b"rtcIntersect16\0": Trace16), bind!(b"rtcOccluded16\0": Trace16)],
                _library: library,
            })
        }
    }

    /// The number of rays that hit, traced one by one or in packets.
    pub fn hits(&self, rays: &[([f32; 3], [f32; 3])], any: bool, in_packets: bool, is_coherent: bool) -> usize {
        let mut context = Context {
            flags: if is_coherent { COHERENT } else { 0 },
            filter: ptr::null(),
            instance: u32::MAX,
        };
        let mut met = 0;
        if !in_packets {
            for ray in rays {
                let mut hits = RayHits::<1>::of(std::slice::from_ref(ray));
                // SAFETY: scene, context and ray are as `rtcore.h` wants them.
                unsafe { self.one[usize::from(any)](self.scene, &raw mut context, &raw mut hits) };
                met += hits.count(any, 1);
            }
            return met;
        }
        for rays in rays.chunks(PACKET) {
            let mut hits = RayHits::<16>::of(rays);
            let valid: [c_int; 16] = std::array::from_fn(|ray| if ray < rays.len() { -1 } else { 0 });
            // SAFETY: as above.
            unsafe { self.sixteen[usize::from(any)](valid.as_ptr(), self.scene, &raw mut context, &raw mut hits) };
            met += hits.count(any, rays.len());
        }
        met
    }
}

impl<const N: usize> RayHits<N> {
    fn of(rays: &[([f32; 3], [f32; 3])]) -> Self {
        let ray = |number: usize| &rays[number.min(rays.len() - 1)];
        let each = |of: &dyn Fn(usize) -> f32| std::array::from_fn(of);
        Self {
            origin: [0, 1, 2].map(|axis| each(&|i| ray(i).0[axis])),
            t_min: [0.0; N],
            direction: [0, 1, 2].map(|axis| each(&|i| ray(i).1[axis])),
            time: [0.0; N],
            t_max: [f32::MAX; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            coordinates: [[0.0; N]; 2],
            triangle: [u32::MAX; N],
            geometry: [u32::MAX; N],
            instance: [u32::MAX; N],
        }
    }

    /// Of the first `count` rays those that hit; an occluded ray has a length (`tfar`) of −∞.
    fn count(&self, any: bool, count: usize) -> usize {
        let is_hit = |i: &usize| {
            if any {
                self.t_max[*i] < 0.0
            } else {
                self.geometry[*i] != u32::MAX
            }
        };
        (0..count).filter(is_hit).count()
    }
}
